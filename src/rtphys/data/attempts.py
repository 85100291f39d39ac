"""Rows of a task dataset's ledger: one an attempt, and what they add up to."""

from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path
from typing import Annotated, Literal, Self

from pydantic import Field, FiniteFloat, JsonValue

from rtphys.core.bounds import EPISODES
from rtphys.core.errors import BadFile
from rtphys.data.files import FileFacts
from rtphys.data.json_text import Model, Seed
from rtphys.data.layout import LEDGER, EpisodePaths, TaskDataset
from rtphys.data.ledger import has_begun, read_header, read_rows
from rtphys.spec.collection import TaskHeader

Number = Annotated[int, Field(ge=0, le=EPISODES)]
EpisodeFile = Annotated[
    str, Field(pattern=r"^(failures/)?[a-z_]{1,20}/episode_?[0-9]{1,9}\.[a-z0-9]{2,4}$")
]
"""Path of a file of an episode below its task dataset, as `EpisodePaths` has it."""


class OnDisk(Model):
    """What lies on disk of an attempt."""

    frames: Number
    scene_info: dict[str, JsonValue]
    files: dict[EpisodeFile, FileFacts]


class Accepted(OnDisk):
    """An attempt that gave an episode."""

    seed: Seed
    verdict: Literal["accepted"] = "accepted"
    episode: Number
    physics: dict[str, JsonValue] = Field(description="value of every attribute that could act")
    recovered: bool = Field(default=False, description="a load was lost and taken again")

    @property
    def on_disk(self) -> Self:
        return self

    @property
    def number(self) -> int:
        return self.episode

    def paths(self, place: TaskDataset) -> EpisodePaths:
        """Its files, where the task dataset lies in `place`."""
        return place.episode(self.episode)


class KeptFailure(OnDisk):
    """Files of an attempt that failed: number i is `failures/*/episode_<i>`."""

    number: Number
    event: str = Field(description="see `failure.event` of its label")
    time: FiniteFloat = Field(description="s, when it went wrong")

    def paths(self, place: TaskDataset) -> EpisodePaths:
        """Its files, where the task dataset lies in `place`."""
        return place.failures.episode(self.number)


class Rejected(Model):
    """An attempt that gave none."""

    seed: Seed
    verdict: Literal["rejected"] = "rejected"
    reason: str
    detail: str
    physics: dict[str, JsonValue]
    kept: KeptFailure | None = None

    @property
    def on_disk(self) -> KeptFailure | None:
        return self.kept


Row = Accepted | Rejected
ATTEMPT: type[Row] = Annotated[Row, Field(discriminator="verdict")]  # type: ignore[assignment]
"""What pydantic reads a row as."""


@dataclass
class Totals:
    """What the attempts of a task dataset add up to."""

    episodes: int = 0
    frames: int = 0
    attempts: int = 0
    failures: int = 0  # failed attempts whose files are kept
    recovered: int = 0  # episodes in which a load was lost and taken again
    rejections: Counter[str] = field(default_factory=Counter[str])  # by reason
    could_act: set[str] = field(default_factory=set[str])  # attributes that could in some attempt
    since_accepted: int = 0  # attempts since the last episode
    last_seed: int = -1

    def add(self, row: Row) -> None:
        """Counts one more attempt. Raises `ValueError`: its number is not the next one."""
        accepted = isinstance(row, Accepted)
        what, number = ("episode", self.episodes) if accepted else ("failure", self.failures)
        if row.on_disk and row.on_disk.number != number:
            raise ValueError(f"{what} is {row.on_disk.number}, but it is number {number} here")
        if row.seed <= self.last_seed:
            raise ValueError(f"seed {row.seed} follows seed {self.last_seed}")
        self.attempts += 1
        self.last_seed = row.seed
        self.could_act.update(row.physics)
        self.since_accepted = 0 if accepted else self.since_accepted + 1
        if accepted:
            self.episodes += 1
            self.frames += row.frames
            self.recovered += row.recovered
        else:
            self.failures += row.kept is not None
            self.rejections[row.reason] += 1


def read_attempts(path: Path) -> Iterator[Row]:
    """Every attempt of a task dataset in order. Raises `BadFile`, which names line and key."""
    return read_rows(ATTEMPT, path)


def ledgers_below(out: Path) -> dict[Path, TaskHeader]:
    """Ledgers of both layouts, sorted by task dataset, with what their first lines say.

    A ledger without a whole first line is left out: its run was killed before it began.

    Raises `BadFile`: one is damaged, lies where another belongs, or is reached through a link.
    """
    paths = [*out.glob(f"*/*/*/{LEDGER}"), *out.glob(f"*/*/{LEDGER}")]
    found: dict[Path, TaskHeader] = {}
    for path in sorted(paths, key=lambda path: path.parent.relative_to(out).as_posix()):
        if has_begun(path):
            header = read_header(TaskHeader, path)
            place = TaskDataset.of(out, header.spec)
            if place.ledger != path:
                raise BadFile(path, f"belongs to {place.name}")
            place.check_links()
            found[path] = header
    return found
