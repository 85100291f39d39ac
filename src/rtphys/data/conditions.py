"""Conditions of a task dataset: equal conditions may continue each other's work."""

from collections.abc import Mapping
from dataclasses import dataclass, field, fields
from pathlib import Path

from rtphys.core.errors import UnknownName
from rtphys.data.episode import JSON
from rtphys.data.json_text import plain
from rtphys.data.layout import EMBODIMENT, LAYOUTS, TaskDataset
from rtphys.data.schema import DATASET_VERSION


@dataclass(frozen=True)
class Conditions:
    """Everything that decides the episodes of a task dataset; the journal's first line."""

    task: str
    protocol: str
    first_seed: int
    domain_name: str
    domain_digest: str
    domain: Mapping[str, object]  # resolved, `Domain.to_json()`
    cameras: tuple[str, ...]  # official names, such as head_camera
    versions: Mapping[str, str]  # rtphys, sapien, numpy, python, ...
    assets: Mapping[str, str]  # pack, digest
    only: tuple[str, ...] | None = None
    overrides: Mapping[str, object] = field(default_factory=dict)
    embodiment: str = EMBODIMENT
    layout: str = "native"
    visual: Mapping[str, object] | None = None  # rules of the look, resolved
    config: str | None = None  # name of the folder; None: named after the protocol
    split: str | None = None  # of its pictures; None where nothing is drawn
    twin: str | None = None  # config of the task dataset of the same seeds
    twin_of: str | None = None  # config of the task dataset whose twin this is
    recovery: bool | None = None  # False: episodes with a recovery are left out; None: kept
    stride: tuple[int, int] | None = None  # of a shard: its first attempt, its step; None: 0, 1

    def __post_init__(self) -> None:
        if self.layout not in LAYOUTS:
            raise UnknownName("layout", self.layout, LAYOUTS)

    def seed(self, attempt: int) -> int:
        """Of the attempt with that number, counted from 0."""
        first, step = self.stride or (0, 1)
        return self.first_seed + first + attempt * step

    def attempt(self, seed: int) -> int:
        """Inverse of `seed`."""
        first, step = self.stride or (0, 1)
        return (seed - self.first_seed - first) // step

    def task_dataset(self, out: Path) -> TaskDataset:
        config = self.config or self.protocol
        return TaskDataset(out, config, self.task, self.embodiment, self.layout)

    @staticmethod
    def from_json(header: Mapping[str, JSON]) -> "Conditions":
        """Inverse of `to_json`, for the first line of a journal."""
        names = [f.name for f in fields(Conditions) if f.name in header]
        found = {n: tuple(v) if isinstance(v := header[n], list) else v for n in names}
        return Conditions(**found)  # type: ignore[arg-type] - to_json wrote them

    def to_json(self) -> dict[str, JSON]:
        names = self.__dataclass_fields__
        found = {name: plain(getattr(self, name), name) for name in names}
        return {**found, "dataset_version": DATASET_VERSION}


def differences(stored: Mapping[str, JSON], wanted: Mapping[str, JSON]) -> list[str]:
    """One clause for each condition that is not the same, nested keys spelled with dots."""
    found: list[str] = []
    for key in sorted({*stored, *wanted}):
        old, new = stored.get(key), wanted.get(key)
        if old == new:
            continue
        if isinstance(old, Mapping) and isinstance(new, Mapping):
            found += [f"{key}.{clause}" for clause in differences(old, new)]
        else:
            found.append(f"{key} was {old!r}, now {new!r}")
    return found
