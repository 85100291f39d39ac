"""The journal of a task dataset as typed entries: its conditions, then one entry an attempt."""

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Annotated, Literal

from pydantic import ConfigDict, Field, FiniteFloat, JsonValue

from rtphys.core.bounds import EPISODES
from rtphys.core.errors import BadFile
from rtphys.data import schema
from rtphys.data.episode import JSON
from rtphys.data.files import FileFacts
from rtphys.data.journal import Contents, Line, read_journal
from rtphys.data.layout import TaskDataset
from rtphys.data.manifest import task_dataset_of
from rtphys.data.schema_model import KeepFailures, Model, Name, RelativePath, Seed, Stride


class _Entry(Model):
    """Other keys are those of newer versions, or compared elsewhere."""

    model_config = ConfigDict(extra="ignore", frozen=True, strict=True)


class Header(_Entry):
    """First line of a journal: the conditions, as `Conditions.to_json` writes them."""

    task: Name
    protocol: Name
    config: Name | None = None
    embodiment: Name
    layout: Literal["native", "legacy"]
    first_seed: Seed
    stride: Stride | None = None
    only: list[str] | None
    overrides: dict[str, JsonValue]
    split: Literal["seen", "unseen"] | None = None
    recovery: bool | None = None
    pair_tasks: bool = False
    keep_failures: KeepFailures | None = None
    policy: str | None = None
    twin: Name | None = None
    twin_of: Name | None = None
    domain: dict[str, JsonValue]
    domain_name: str
    domain_digest: str
    visual: dict[str, JsonValue] | None = None
    cameras: list[str]
    versions: dict[str, str]
    assets: dict[str, str]
    dataset_version: schema.Version | None = None


class Accepted(_Entry):
    """An attempt that gave an episode."""

    seed: Seed
    verdict: Literal["accepted"]
    episode: Annotated[int, Field(ge=0, le=EPISODES)]
    frames: Annotated[int, Field(ge=0, le=EPISODES)]
    scene_info: dict[str, JsonValue]
    physics: dict[str, JsonValue] | None = None
    recovered: bool = False
    files: dict[RelativePath, FileFacts]


class Kept(_Entry):
    """A failed attempt whose files were kept."""

    number: Annotated[int, Field(ge=0, le=EPISODES)]
    frames: Annotated[int, Field(ge=0, le=EPISODES)]
    event: str
    time: FiniteFloat
    scene_info: dict[str, JsonValue]
    files: dict[RelativePath, FileFacts]


class Rejected(_Entry):
    """An attempt that gave none."""

    seed: Seed
    verdict: Literal["rejected"]
    reason: str
    detail: str
    physics: dict[str, JsonValue] | None = None
    kept: Kept | None = None


class _Attempt(_Entry):
    attempt: Annotated[Accepted | Rejected, Field(discriminator="verdict")]


def read_attempts(path: Path) -> Contents:
    """Reads a task dataset's journal and checks its chain and every entry.

    Raises:
        BadFile: a line is damaged or no entry; names the line.
    """
    contents = read_journal(path)
    check_entries(path, [line.entry for line in contents.lines])
    return contents


def check_entries(path: Path, entries: Sequence[Mapping[str, JSON]]) -> None:
    """Raises `BadFile`: an entry has not what every entry has; names the line."""
    numbers = {"episode": 0, "failure": 0}
    for place, entry in enumerate(entries, start=1):
        with schema.problems_of(Path(f"{path} line {place}")):
            if place == 1:
                Header.model_validate(entry)
                continue
            attempt = _Attempt.model_validate({"attempt": entry}).attempt
        if isinstance(attempt, Accepted):
            kind, number = "episode", attempt.episode
        elif attempt.kept is not None:
            kind, number = "failure", attempt.kept.number
        else:
            continue
        if number != numbers[kind]:
            problem = f"{kind} is {number}, but it is number {numbers[kind]} here"
            raise BadFile(f"{path} line {place}", problem)
        numbers[kind] += 1


def own_place(out: Path, path: Path, lines: Sequence[Line]) -> TaskDataset:
    """The task dataset of a journal below `out`. Raises `BadFile`: it is another's, or a link."""
    place = task_dataset_of(out, lines[0].entry)
    if place.journal != path:
        raise BadFile(path, f"belongs to {place.name}")
    place.check_links()
    return place
