"""Paths of the files of a dataset, which no other module spells."""

import re
from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import Path

from rtphys.assets.embodiment import DEFAULT
from rtphys.core.errors import BadValue
from rtphys.core.untrusted import check_inside, plain_name
from rtphys.spec.collection import CollectionSpec

MANIFEST = "manifest.json"
LOCK = ".rtphys.lock"
HELD = ".held"  # ends the name of a lock where the file system has none
REPORT = "report.html"  # of a dataset, or of an evaluation
LEDGER = "ledger.jsonl"
STAGING = ".staging"
EPISODE_FOLDERS = ("data", "video", "phys_meta", "instruction", "instructions")
FAILURES = "failures"  # beside the episodes of a task dataset: attempts that failed, if kept


def embodiment_folder(name: str) -> str:
    """`aloha-agilex` -> `aloha_agilex`, the official rule."""
    return re.sub(r"[^A-Za-z0-9_]+", "_", name).lower()


EMBODIMENT = embodiment_folder(DEFAULT)


@dataclass(frozen=True)
class EpisodePaths:
    """The files of one episode. Paths are made on use: a dataset may list a million episodes."""

    folder: Path
    stem: str
    words: str  # folder of the sentences

    @property
    def hdf5(self) -> Path:
        return self.folder / "data" / f"{self.stem}.hdf5"

    @property
    def video(self) -> Path:
        return self.folder / "video" / f"{self.stem}.mp4"

    @property
    def phys_meta(self) -> Path:
        return self.folder / "phys_meta" / f"{self.stem}.json"

    @property
    def instruction(self) -> Path:
        return self.folder / self.words / f"{self.stem}.json"

    def all(self) -> tuple[Path, ...]:
        return (self.hdf5, self.video, self.phys_meta, self.instruction)


@dataclass(frozen=True)
class TaskDataset:
    """The folder of one task under one configuration (the protocol's name)."""

    out: Path
    config: str
    task: str
    embodiment: str  # as `embodiment_folder` spells it
    layout: str
    failed: bool = False  # the folder in it that holds the failures that were kept

    def __post_init__(self) -> None:
        for key in ("config", "task", "embodiment"):
            try:
                plain_name(getattr(self, key))
            except ValueError as error:
                raise BadValue(key, getattr(self, key), str(error)) from error

    @staticmethod
    def of(out: Path, spec: CollectionSpec) -> "TaskDataset":
        """The one that a spec makes below `out`."""
        episode = spec.episode
        folder = embodiment_folder(episode.embodiment)
        return TaskDataset(out, spec.name, episode.task, folder, spec.recording.layout)

    @cached_property
    def name(self) -> str:
        """Path below `out`, with forward slashes; its key in the manifest."""
        inner = f"/{FAILURES}" if self.failed else ""
        if self.layout == "legacy":
            return f"{self.task}/{self.config}{inner}"
        return f"{self.config}/{self.task}/{self.embodiment}{inner}"

    @property
    def failures(self) -> "TaskDataset":
        """Where kept failures lie: the same files as of episodes, with numbers of their own."""
        return replace(self, failed=True)

    @cached_property
    def folder(self) -> Path:
        return self.out / self.name

    def episode(self, number: int) -> EpisodePaths:
        if self.layout == "legacy":
            return EpisodePaths(self.folder, f"episode{number}", "instructions")
        return EpisodePaths(self.folder, f"episode_{number:07d}", "instruction")

    def check_links(self) -> None:
        """Raises `BadFile` where a folder or a file with a fixed place is a link."""
        check_inside(self.out, folder := self.folder)
        own = (self.scene_info, self.seed_txt, self.seeds_txt, folder / LEDGER)
        for path in (*own, *(folder / name for name in (*EPISODE_FOLDERS, STAGING, FAILURES))):
            check_inside(folder, path)
        if not self.failed:
            self.failures.check_links()

    @property
    def scene_info(self) -> Path:
        return self.folder / "scene_info.json"

    @property
    def seed_txt(self) -> Path:
        """Official: accepted seeds, each followed by a space, no newline."""
        return self.folder / "seed.txt"

    @property
    def seeds_txt(self) -> Path:
        """Ours: one accepted seed a line; line i belongs to episode i."""
        return self.folder / "seeds.txt"

    @property
    def ledger(self) -> Path:
        """That of the task dataset, which lists its kept failures too."""
        return (self.folder.parent if self.failed else self.folder) / LEDGER

    @property
    def staging(self) -> Path:
        """Where workers put the files of attempts that have no episode number yet."""
        return self.folder / STAGING


def episode_number(path: Path) -> int | None:
    """Number in an episode file's name of either layout, or None."""
    match = re.fullmatch(r"episode_?(\d+)", path.stem)
    return int(match[1]) if match else None
