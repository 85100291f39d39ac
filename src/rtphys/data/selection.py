"""Which episodes of a dataset are meant: the selectors of `show`, `view`, `render` and `export`."""

from pathlib import Path
from typing import Annotated

from rtphys.core.errors import BadFile, BadValue, counted
from rtphys.data.dataset import Dataset, Episode, find_episode
from rtphys.data.layout import MANIFEST
from rtphys.spec.option import Option, Seed, checked_dataclass


@checked_dataclass(frozen=True)
class Selection:
    """A part of a dataset; all of it by default."""

    task: Annotated[str | None, Option("Only of this task.")] = None
    config: Annotated[str | None, Option("Only of this configuration.")] = None
    seed: Annotated[str, Option("Only of these seeds: 3,7 or 0:50.")] = ""

    def __post_init__(self) -> None:
        seed_set("seed", self.seed)

    def of(self, dataset: Dataset) -> Dataset:
        """That part. Raises `UnknownName`."""
        seeds = seed_set("seed", self.seed) if self.seed else None
        return dataset.where(self.task, config=self.config, seeds=seeds)


@checked_dataclass(frozen=True)
class One(Selection):
    """One episode, or one failure that was kept."""

    episode: Annotated[Seed | None, Option("Its number in its task dataset; default: any.")] = None
    failure: Annotated[Seed | None, Option("Instead: number of a failure that was kept.")] = None

    def of_path(self, path: Path) -> tuple[Episode, ...]:
        """Every episode that fits, at least one, of a dataset or of any file of an episode.

        Raises `UnknownName`, `BadValue`, `BadFile`: none fits.
        """
        if not path.is_dir() and path.name != MANIFEST:
            return (find_episode(path),)
        dataset = self.of(Dataset(path))
        failures = dataset.failures()
        if self.failure is not None:
            kind, number, known = "failure", self.failure, failures
        else:
            kind, number, known = "episode", self.episode, tuple(dataset)
            if self.seed and number is None:  # which says it without either
                known += failures
        if not known:
            others = f", but {counted(len(failures), 'failures')}: `failure` 0" if failures else ""
            which = "such " if self != One() else ""
            raise BadFile(path, f"the dataset holds no {which}{kind}{others}")
        if not (found := tuple(one for one in known if number in (None, one.number))):
            most = max(one.number for one in known)
            raise BadValue(kind, number, f"the dataset holds {kind}s 0 to {most}")
        return found


def seed_set(option: str, text: str) -> frozenset[int]:
    """Seeds of "3,7" or "0:50", the end not among them. Raises `BadValue`."""
    found: set[int] = set()
    for part in filter(None, text.split(",")):
        first, colon, end = part.partition(":")
        if not (first.isdecimal() and (end.isdecimal() or not colon)):
            raise BadValue(option, text, "write seeds such as 3,7 or a range such as 0:50")
        found.update(range(int(first), int(end)) if colon else (int(first),))
    return frozenset(found)
