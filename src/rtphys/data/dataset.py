"""A dataset as Python objects: lazy, without a simulator, pictures always RGB.

```python
for episode in rtphys.Dataset("data").where(task="click_bell"):
    print(episode.seed, episode.physics["friction"], episode.images("head_camera").shape)
```
"""

import math
import operator
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property, partial
from itertools import chain
from numbers import Real
from pathlib import Path
from typing import TYPE_CHECKING, Literal, NamedTuple, SupportsIndex, TypeVar, cast, overload

import numpy as np
from numpy.typing import NDArray

from rtphys.core.bounds import MAX_PICTURES
from rtphys.core.errors import BadFile, BadValue, RtphysError, UnknownName, counted
from rtphys.data import jpeg, schema
from rtphys.data.attempts import Accepted, Rejected, Row
from rtphys.data.episode import Frames
from rtphys.data.files import FileFacts
from rtphys.data.hdf5_episode import EpisodeFile
from rtphys.data.hdf5_senses import SenseFile
from rtphys.data.layout import (
    MANIFEST,
    EpisodePaths,
    TaskDataset,
    embodiment_folder,
    episode_number,
)
from rtphys.data.manifest import Manifest, TaskEntry, read_manifest
from rtphys.data.schema import Failure, FailureMeta, Instructions, PhysMeta
from rtphys.physics import Physics, attributes
from rtphys.physics.attribute import attribute, is_attribute
from rtphys.physics.values import Value, plain_value
from rtphys.spec.sweep import families

if TYPE_CHECKING:
    from pandas import DataFrame  # type: ignore[import-untyped]

Read = TypeVar("Read")

FACTS = ("task", "config", "embodiment", "seed", "number", "frames", "outcome")
"""First columns of a table of episodes; those of the attributes follow."""


@dataclass(frozen=True)
class Episode:
    """One stored episode. Reads a file when asked for something in it; pickles small.

    Frames are 0.06 s apart. `state[t]` is the command in force at frame t, `action[t]` the one of
    frame t + 1, so `action` has one row less than there are pictures.
    """

    task: str
    protocol: str
    config: str  # name of the configuration; the protocol's, unless it is one of a sweep or a twin
    embodiment: str
    number: int
    seed: int
    layout: str
    paths: EpisodePaths
    failed: bool = False  # one of `Dataset.failures`

    def __getstate__(self) -> dict[str, object]:
        # Without what was read: a data loader's workers read for themselves.
        return {name: self.__dict__[name] for name in self.__dataclass_fields__}

    @cached_property
    def frames(self) -> Frames:
        """Everything but pictures, T rows; poses are xyz [m] + wxyz, world. Raises `BadFile`."""
        return self._file.frames()

    @cached_property
    def meta(self) -> PhysMeta:
        """The label. Raises `BadFile`."""
        return schema.read(FailureMeta if self.failed else PhysMeta, self.paths.phys_meta)

    @cached_property
    def failure(self) -> Failure | None:
        """Why and when it went wrong; None for a success. Raises `BadFile`."""
        meta = self.meta
        return meta.failure if isinstance(meta, FailureMeta) else None

    @property
    def physics(self) -> Physics:
        """The attributes and the auxiliary draws, in their units. Raises `BadFile`."""
        labels = self.meta.attributes
        try:
            values = {key: plain_value(label.value) for key, label in labels.items()}
            draws = {key: plain_value(raw) for key, raw in self.meta.draws.items()}
        except ValueError as error:
            raise BadFile(self.paths.phys_meta, str(error)) from error
        return Physics(draws | values, [key for key, label in labels.items() if label.varied])

    @property
    def factors(self) -> Mapping[str, Value]:
        """The attributes that could act here, and did as far as that was measured: what a
        correlation may be asked about. Raises `BadFile`."""
        physics, labels = self.physics, self.meta.attributes
        return {key: physics[key] for key, label in labels.items() if schema.informs(key, label)}

    @cached_property
    def instructions(self) -> Instructions:
        """Sentences, `seen` and `unseen`."""
        return schema.read(Instructions, self.paths.instruction)

    @property
    def name(self) -> str:
        """For files: all that it differs in from any other of its dataset."""
        kind = "failure" if self.failed else "episode"
        robot = embodiment_folder(self.embodiment)
        return f"{self.task}_{self.config}_{robot}_{kind}_{self.number}"

    @property
    def senses(self) -> SenseFile:
        """Depth, ids, point clouds, body poses and touch, if they were recorded."""
        return SenseFile(self.paths.hdf5, self.layout, self.cameras)

    @property
    def cameras(self) -> tuple[str, ...]:
        """Official names: head_camera, left_camera, right_camera, front_camera."""
        return tuple(self.frames.cameras)

    @property
    def state(self) -> NDArray[np.float64]:
        """(T, N) commanded: left arm [rad], left gripper 0..1, then the right ones."""
        return self.frames.vector

    @property
    def action(self) -> NDArray[np.float64]:
        """(T - 1, N), row t is the command of frame t + 1."""
        return self.frames.vector[1:]

    def __len__(self) -> int:
        """Number of frames T."""
        return len(self.frames)

    def image(self, camera: str, frame: int) -> NDArray[np.uint8]:
        """One picture (H, W, 3), RGB. Raises `UnknownName`, `IndexError`, `BadFile`."""
        return self._picture(jpeg.decode, camera, frame, self._file.stream(camera, frame))

    def images(self, camera: str) -> NDArray[np.uint8]:
        """All pictures of a camera (T, H, W, 3), RGB. Raises `UnknownName`, `BadFile`."""
        streams = self._file.streams(camera)
        shapes = {self._picture(jpeg.shape_of, camera, t, one) for t, one in enumerate(streams)}
        if len(shapes) > 1:
            raise BadFile(self.paths.hdf5, f"pictures of {camera} differ in size")
        if (size := len(streams) * max(map(math.prod, shapes), default=0)) > MAX_PICTURES:
            problem = f"{size} bytes of pictures of {camera}; take them with each_image"
            raise BadFile(self.paths.hdf5, problem)
        return np.stack([self._picture(jpeg.decode, camera, *one) for one in enumerate(streams)])

    def each_image(self, camera: str) -> Iterator[NDArray[np.uint8]]:
        """The pictures of a camera one after the other, (H, W, 3) RGB.

        Raises `UnknownName`, `BadFile`.
        """
        streams = enumerate(self._file.streams(camera))
        return (self._picture(jpeg.decode, camera, t, stream) for t, stream in streams)

    def _picture(
        self, read: Callable[[bytes], Read], camera: str, frame: int, stream: bytes
    ) -> Read:
        """What is read of a picture's stream. Raises `BadFile`: it is broken."""
        try:
            return read(stream)
        except jpeg.BadImage as error:
            raise BadFile(self.paths.hdf5, f"{camera}, frame {frame}: {error}") from error

    def poses(self, name: str, order: Literal["wxyz", "xyzw"] = "wxyz") -> NDArray[np.float64]:
        """(T, 7) xyz [m] + quaternion in the order asked for, world frame.

        Args:
            name: "left" or "right" for an end effector (its ee frame), otherwise an object.
            order: "wxyz" as stored, or "xyzw".
        """
        known = {"left": self.frames.left_endpose, "right": self.frames.right_endpose}
        known |= dict(self.frames.object_poses)
        if name not in known:
            raise UnknownName("pose", name, known, self.paths.hdf5)
        if order not in ("wxyz", "xyzw"):
            raise BadValue("order", order, "it is wxyz or xyzw")
        pose = np.array(known[name], np.float64)
        return pose if order == "wxyz" else pose[:, [0, 1, 2, 4, 5, 6, 3]]

    @property
    def _file(self) -> EpisodeFile:
        return EpisodeFile(self.paths.hdf5, self.layout)


class Pair(NamedTuple):
    """One seed under two protocols."""

    episode: Episode
    twin: Episode


@dataclass(frozen=True)
class Part:
    """A task dataset, the dataset that it lies in, and which of its attempts are meant."""

    path: Path
    manifest: Manifest
    entry: TaskEntry
    tests: tuple[Callable[[Row], bool], ...] = ()  # that an attempt passes if it is meant

    @property
    def place(self) -> TaskDataset:
        """Where its files lie."""
        return self.entry.below(self.path)

    def takes(self, row: Row) -> bool:
        """Whether one of its attempts is meant."""
        return all(test(row) for test in self.tests)

    def rows(self) -> Iterator[Row]:
        """Attempts as far as the manifest counts, in order. Raises `BadFile`."""
        self.place.check_links()
        return filter(self.takes, self.entry.rows(self.path))

    def physics(self, row: Row, raw: bool) -> Mapping[str, object]:
        """Attribute -> value of those that acted, as far as that was measured.

        With `raw`, and of an attempt without files: of all that could act. Raises `BadFile`.
        """
        if raw or (held := row.on_disk) is None:
            return row.physics
        kind = FailureMeta if isinstance(row, Rejected) else PhysMeta
        meta = schema.read(kind, held.paths(self.place).phys_meta)
        labels = meta.attributes.items()
        return {key: label.value for key, label in labels if schema.informs(key, label)}

    def episodes(self, failed: bool = False) -> Iterator[Episode]:
        """Its episodes, or the failures that were kept. Raises `BadFile`."""
        spec, place = self.entry.spec, self.place
        of = spec.episode.task, spec.episode.protocol, spec.name, spec.episode.embodiment
        for row in self.rows():
            if (held := row.on_disk) is not None and isinstance(row, Rejected) is failed:
                paths, layout = held.paths(place), spec.recording.layout
                yield Episode(*of, held.number, row.seed, layout, paths, failed)


# Functions and no closures, so that a part of a dataset can be pickled.
def _has_seed(seeds: frozenset[int], row: Row) -> bool:
    return row.seed in seeds


def _has_number(numbers: frozenset[int], row: Row) -> bool:
    return isinstance(row, Accepted) and row.episode in numbers


def _lies_within(key: str, low: float, high: float, row: Row) -> bool:
    found = flattened({key: row.physics.get(key)}).values()
    return bool(found) and all(low <= number <= high for number in found)


def _range(key: str, ends: object) -> tuple[float, float]:
    """Lowest and highest value. Raises `BadValue`."""
    parts = cast(Sequence[object], ends) if isinstance(ends, list | tuple) else ()
    numbers = [float(part) for part in parts if isinstance(part, Real)]
    if len(parts) != 2 or len(numbers) != 2 or not numbers[0] <= numbers[1]:
        example = f"({ends}, {ends})" if isinstance(ends, Real) else "(0.1, 0.3)"
        allowed = f"it needs the lowest and the highest value, such as {example}"
        raise BadValue(f"physics[{key!r}]", ends, allowed)
    return numbers[0], numbers[1]


def _numbers_of(name: str, given: object) -> frozenset[int]:
    """Seeds or episode numbers. Raises `BadValue`: one alone, or something else."""
    try:
        return frozenset(
            operator.index(cast(SupportsIndex, one)) for one in cast(Iterable[object], given)
        )
    except TypeError as error:
        example = f"[{given}]" if isinstance(given, int) else "[3, 7]"
        raise BadValue(name, given, f"whole numbers, such as {example} or range(50)") from error


def columns(key: str) -> list[str]:
    """Names of an attribute's columns in a table, vectors by component: `center_of_mass.x`."""
    size = attribute(key).size
    return [key] if size == 1 else [f"{key}.{axis}" for axis in "xyz"[:size]]


def flattened(values: Mapping[str, object]) -> dict[str, float]:
    """The numbers among the values of attributes in a ledger or label, by these names."""
    found: dict[str, float] = {}
    for key, value in values.items():
        several = isinstance(value, list | tuple)
        parts = cast(Sequence[object], value) if several else (value,)
        names = [f"{key}.{axis}" for axis in "xyz"] if several else [key]
        pairs = zip(names, parts, strict=False)
        found |= {name: float(one) for name, one in pairs if isinstance(one, int | float)}
    return found


class Dataset(Sequence[Episode]):
    """The episodes of a folder that holds `manifest.json`, in the manifest's order.

    `Dataset("a") + Dataset("b")` has the episodes of both.
    """

    def __init__(self, path: str | Path) -> None:
        """Raises `BadFile` when there is no dataset; reads the manifest, no episode."""
        given = Path(path)
        folder = given.parent if given.name == MANIFEST else given
        manifest = read_manifest(folder)
        self.parts = tuple(
            Part(folder, manifest, entry) for entry in manifest.task_datasets.values()
        )
        self._folders = {folder: manifest}

    @staticmethod
    def _of(parts: Iterable[Part], folders: Mapping[Path, Manifest]) -> "Dataset":
        made = object.__new__(Dataset)
        made.parts, made._folders = tuple(parts), dict(folders)
        return made

    def __add__(self, other: "Dataset") -> "Dataset":
        return Dataset._of(self.parts + other.parts, self._folders | other._folders)

    @property
    def path(self) -> Path:
        """Its folder. Raises `BadValue`: it has several, being a sum."""
        if len(self._folders) > 1:
            allowed = "this needs a dataset of one folder: `rtphys merge` writes one"
            raise BadValue("dataset", " + ".join(map(str, self._folders)), allowed)
        return next(iter(self._folders))

    @property
    def manifest(self) -> Manifest:
        """Of its folder. Raises `BadValue`: it has several, being a sum."""
        return self._folders[self.path]

    @property
    def task_datasets(self) -> tuple[TaskEntry, ...]:
        return tuple(part.entry for part in self.parts)

    @cached_property
    def _episodes(self) -> tuple[Episode, ...]:
        return tuple(chain.from_iterable(part.episodes() for part in self.parts))

    @property
    def tasks(self) -> tuple[str, ...]:
        return tuple(dict.fromkeys(one.spec.episode.task for one in self.task_datasets))

    @property
    def protocols(self) -> tuple[str, ...]:
        return tuple(dict.fromkeys(one.spec.episode.protocol for one in self.task_datasets))

    @property
    def configs(self) -> tuple[str, ...]:
        """Names of the folders: a protocol's, or one of a sweep or twin."""
        return tuple(dict.fromkeys(one.spec.name for one in self.task_datasets))

    @property
    def embodiments(self) -> tuple[str, ...]:
        return tuple(dict.fromkeys(one.spec.episode.embodiment for one in self.task_datasets))

    def where(
        self,
        task: str | Iterable[str] | None = None,
        protocol: str | Iterable[str] | None = None,
        embodiment: str | Iterable[str] | None = None,
        config: str | Iterable[str] | None = None,
        physics: Mapping[str, tuple[float, float]] | None = None,
        seeds: Iterable[int] | None = None,
        numbers: Iterable[int] | None = None,
    ) -> "Dataset":
        """The episodes of some tasks, protocols, robots, configurations, physics or seeds.

        Args:
            task: one name or several, as for all that have names.
            protocol: all its configurations, those too in which an attribute is swept, held or
                picked. `protocol="clean"` so returns episodes of `clean.friction=0.05`.
            config: one of them, a name among `configs`. `config="clean"` is plain clean.
            physics: attribute -> lowest and highest value, such as {"friction": (0.1, 0.3)}, for
                each component of a vector. Episodes where it could not act are left out.
            seeds: such as [3, 7] or range(50).
            numbers: of episodes in their task datasets.

        Raises `UnknownName`, `BadValue`.
        """
        tasks = self._names("task", task, self.tasks)
        protocols = self._names("protocol", protocol, self.protocols)
        robots = self._names("embodiment", embodiment, self.embodiments, embodiment_folder)
        configs = self._names("configuration", config, self.configs)
        acting = {key for part in self.parts for key in part.entry.could_act}
        tests: list[Callable[[Row], bool]] = []
        for key, ends in (physics or {}).items():
            if key not in acting and is_attribute(key):
                allowed = f"it could not act in any episode here; {', '.join(sorted(acting))} could"
                raise BadValue("physics", key, allowed)
            if key not in acting:
                raise UnknownName("attribute", key, acting)
            tests.append(partial(_lies_within, key, *_range(key, ends)))
        if seeds is not None:
            tests.append(partial(_has_seed, _numbers_of("seeds", seeds)))
        if numbers is not None:
            tests.append(partial(_has_number, _numbers_of("numbers", numbers)))
        chosen = (
            replace(part, tests=(*part.tests, *tests))
            for part in self.parts
            for spec in (part.entry.spec,)
            if spec.episode.task in tasks
            and spec.episode.protocol in protocols
            and embodiment_folder(spec.episode.embodiment) in robots
            and spec.name in configs
        )
        return Dataset._of(chosen, self._folders)

    def _names(
        self, kind: str, given: object, known: Iterable[str], spell: Callable[[str], str] = str
    ) -> set[str]:
        """The name or names that are given; all where none is. Raises `UnknownName`."""
        every = set(map(spell, known))
        if given is None:
            return every
        several = isinstance(given, Iterable) and not isinstance(given, str)
        names = {spell(str(one)) for one in (cast(Iterable[object], given) if several else [given])}
        for name in sorted(names - every):
            raise UnknownName(f"recorded {kind}", name, every, "+".join(map(str, self._folders)))
        return names

    def pairs(self) -> tuple[Pair, ...]:
        """Every episode here that was recorded with a twin, and that twin; works after `where` too.

        Both have the same layout, so what differs between them is due to the protocol.
        """
        found: list[Pair] = []
        for part in self.parts:
            for side in part.entry.spec.sides[1:]:
                name = TaskDataset.of(part.path, side).name
                if (entry := part.manifest.task_datasets.get(name)) is not None:
                    twin = replace(part, entry=entry, tests=())
                    twins = {one.seed: one for one in twin.episodes()}
                    # The twin of a run that was cut off, or is going on, may not be there yet.
                    pairs = ((one, twins.get(one.seed)) for one in part.episodes())
                    found += [Pair(one, other) for one, other in pairs if other is not None]
        return tuple(found)

    def groups(self) -> dict[tuple[str, int], tuple[Episode, ...]]:
        """Task and seed -> its episodes under every configuration, kept failures among them.

        The layout of a seed is the same in all, so what differs between them is the physics, as in
        a sweep, the look, or the robot.
        """
        found: dict[tuple[str, int], list[Episode]] = {}
        for part in self.parts:
            for one in (*part.episodes(), *part.episodes(failed=True)):
                found.setdefault((one.task, one.seed), []).append(one)
        return {key: tuple(found[key]) for key in sorted(found)}

    def sweep(self) -> tuple[dict[Value, Episode], ...]:
        """Of every seed of a sweep its episodes by value, such as {0.05: ..., 0.2: ...}.

        Only the attribute that is swept differs between them. A seed has all values; or, where
        failures were kept, those that were, with their failures among them (`Episode.failed`).
        """
        found: list[dict[Value, Episode]] = []
        parts = {id(part.entry.spec): part for part in self.parts if part.entry.spec.sweep}
        for family in families([part.entry.spec for part in parts.values()]):
            by_seed: dict[int, dict[Value, Episode]] = {}
            for spec in family:
                part, (_, value) = parts[id(spec)], spec.swept
                for one in (*part.episodes(), *part.episodes(failed=True)):
                    by_seed.setdefault(one.seed, {})[value] = one
            if family[0].paired:  # a run that was cut off leaves some values ahead of others
                tried = [replace(parts[id(spec)], tests=()).rows() for spec in family]
                common = set.intersection(*({row.seed for row in rows} for rows in tried))
                by_seed = {seed: by_seed[seed] for seed in common & by_seed.keys()}
            found += [by_seed[seed] for seed in sorted(by_seed)]
        return tuple(found)

    def to_pandas(self, attempts: bool = False, raw: bool = False) -> "DataFrame":
        """One row an episode or kept failure: what it is, its length and outcome, its physics.

        Columns: task, config, embodiment, seed, number, frames, outcome ("accepted", or the reason
        of the failure), and every attribute by name, vectors by component. NaN where an attribute
        could not act or did not act, so that no correlation counts it; and where the value is the
        asset's own.

        Args:
            attempts: also those attempts of which no file was kept; with no number and frames, and
                nobody measured what acted in them.
            raw: all values that could act. The ledgers have them; without it every label is read.

        Raises `BadFile`; `RtphysError`: pandas, which rtphys does not bring, is not installed.
        """
        try:
            from pandas import DataFrame  # type: ignore[import-untyped]
        except ImportError as error:
            raise RtphysError(f"{error}; `pip install pandas`") from error
        rows: list[dict[str, object]] = []
        names = {name for key in attributes() for name in columns(key)}
        for part in self.parts:
            of = part.entry.spec
            for row in part.rows():
                if (held := row.on_disk) is None and not attempts:
                    continue
                values: dict[str, object] = {
                    "task": of.episode.task,
                    "config": of.name,
                    "embodiment": of.episode.embodiment,
                    "seed": row.seed,
                    "number": held and held.number,
                    "frames": held and held.frames,
                    "outcome": row.reason if isinstance(row, Rejected) else row.verdict,
                }
                values |= flattened(part.physics(row, raw))
                names |= values.keys() - {*FACTS}
                rows.append(values)
        return DataFrame(rows, columns=[*FACTS, *sorted(names)])

    def failures(self) -> tuple[Episode, ...]:
        """Attempts that failed and were kept, never among the episodes; works after `where` too.

        They have everything that an episode has, and `failure`: why and when it went wrong.
        """
        return tuple(chain.from_iterable(part.episodes(failed=True) for part in self.parts))

    def files(self) -> Iterator[tuple[str, FileFacts]]:
        """Every file of the episodes and failures here: its path below the folder, and its size
        and SHA-256 from the ledger; works after `where` too."""
        for part in self.parts:
            name = part.entry.below(self.path).name
            for row in part.rows():
                for path, facts in (row.on_disk.files if row.on_disk else {}).items():
                    yield f"{name}/{path}", facts

    def __len__(self) -> int:
        if any(part.tests for part in self.parts):
            return len(self._episodes)
        return sum(part.entry.episodes for part in self.parts)

    @overload
    def __getitem__(self, index: int) -> Episode: ...
    @overload
    def __getitem__(self, index: slice) -> tuple[Episode, ...]: ...
    def __getitem__(self, index: int | slice) -> Episode | tuple[Episode, ...]:
        return self._episodes[index]

    def __repr__(self) -> str:
        tasks = counted(len(self.tasks), "tasks")
        folders = " + ".join(map(str, self._folders))
        return f"Dataset({folders!r}: {counted(len(self), 'episodes')} of {tasks})"


def find_episode(path: Path) -> Episode:
    """The episode that any of its four files belongs to. Raises `BadFile`: no dataset lists it."""
    wanted = path.resolve()
    number = episode_number(wanted)  # to resolve four paths, not those of a million episodes
    for folder in wanted.parents:
        if (folder / MANIFEST).is_file():
            dataset = Dataset(folder)
            for episode in (*dataset, *dataset.failures()):
                if episode.number == number and wanted in map(Path.resolve, episode.paths.all()):
                    return episode
            raise BadFile(path, f"is no episode of the dataset {folder}")
    raise BadFile(path, f"there is no {MANIFEST} in any folder above it")
