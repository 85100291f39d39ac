"""Which episodes of a dataset are meant: the selectors of `show`, `view`, `render` and `export`."""

from collections.abc import Collection, Sequence
from pathlib import Path
from typing import Annotated

from rtphys.core.bounds import EPISODES
from rtphys.core.errors import BadFile, BadValue, counted
from rtphys.data.dataset import Dataset, Episode, find_episode
from rtphys.data.layout import MANIFEST
from rtphys.spec.option import Option, Seed, checked_dataclass

HOLDS = "Folder that holds manifest.json."
DataFolder = Annotated[Path, Option(HOLDS, positional=True)]


@checked_dataclass(frozen=True)
class Selection:
    """A part of a dataset; all of it by default."""

    task: Annotated[tuple[str, ...], Option("Only these tasks.")] = ()
    config: Annotated[
        tuple[str, ...],
        Option("Only these configurations, such as clean (plain clean) or clean.friction=0.2."),
    ] = ()
    embodiment: Annotated[str | None, Option("Only this robot.")] = None
    seed: Annotated[str, Option("Only these seeds: 3,7 or 0:50.")] = ""
    episode: Annotated[
        str | None, Option("Only these numbers in their task dataset: 3,7 or 0:50.")
    ] = None

    def __post_init__(self) -> None:
        seed_set("seed", self.seed)
        if self.episode is not None and not seed_set("episode", self.episode):
            raise BadValue("episode", self.episode, "name at least one number")

    def of(self, dataset: Dataset) -> Dataset:
        """That part. Raises `UnknownName`."""
        seeds = seed_set("seed", self.seed) if self.seed else None
        numbers = seed_set("episode", self.episode) if self.episode else None
        configs = whole_names(self.config, dataset.configs)
        part = dataset.where(self.task or None, None, self.embodiment, configs or None)
        return part.where(seeds=seeds, numbers=numbers)


@checked_dataclass(frozen=True)
class One(Selection):
    """One episode, or one failure that was kept."""

    failure: Annotated[Seed | None, Option("A kept failure instead, by its number.")] = None

    def of_path(self, path: Path) -> tuple[Episode, ...]:
        """Every episode that fits, at least one, of a dataset or of any file of an episode.

        Raises `UnknownName`, `BadValue`, `BadFile`: none fits.
        """
        if not path.is_dir() and path.name != MANIFEST:
            episode = find_episode(path)
            if self != One():
                raise BadValue("path", str(path), "a file is of one episode; name it alone")
            return (episode,)
        dataset = Selection(self.task, self.config, self.embodiment, self.seed).of(Dataset(path))
        failures = dataset.failures()
        if self.failure is not None:
            kind, asked, known = "failure", str(self.failure), failures
        else:
            kind, asked, known = "episode", self.episode or "", tuple(dataset)
            if self.seed and not asked:  # which says it without either
                known += failures
        numbers = seed_set(kind, asked)
        if not known:
            others = f", but {counted(len(failures), 'failures')}: `failure` 0" if failures else ""
            which = "such " if self != One() else ""
            raise BadFile(path, f"the dataset holds no {which}{kind}{others}")
        if not (found := tuple(one for one in known if not asked or one.number in numbers)):
            most = max(one.number for one in known)
            raise BadValue(kind, asked, f"the dataset holds {kind}s 0 to {most}")
        return found


def whole_names(parts: Sequence[str], known: Collection[str]) -> list[str]:
    """Names that a command line cut at their commas, such as clean.only=friction,restitution."""
    found, left = list[str](), [*parts]
    while left:
        sizes = range(len(left), 0, -1)
        size = next((n for n in sizes if ",".join(left[:n]) in known), 1)
        found.append(",".join(left[:size]))
        del left[:size]
    return found


def seed_set(option: str, text: str) -> frozenset[int]:
    """Seeds or numbers of "3,7" or "0:50", the end not among them. Raises `BadValue`."""
    found: set[int] = set()
    for part in filter(None, text.split(",")):
        first, colon, end = part.partition(":")
        if not (first.isdecimal() and (end.isdecimal() or not colon)):
            raise BadValue(option, text, "write numbers such as 3,7 or a range such as 0:50")
        start, stop = int(first), int(end) if colon else int(first) + 1
        if not 0 < stop - start <= EPISODES:  # each takes 90 bytes
            raise BadValue(option, text, f"{part} holds no number, or more than {EPISODES}")
        found.update(range(start, stop))
    return frozenset(found)
