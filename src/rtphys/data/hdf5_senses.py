"""What was sensed in an episode's file, in either layout.

Official keys, types and units: depth in mm as float64, segmentation in the palette's colours. The
native layout drops the last frame of official arrays, which lies in `rtphys/last/`.
"""

import json
from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import TypeVar

import h5py
import numpy as np
from numpy.typing import NDArray

from rtphys.core.errors import UnknownName
from rtphys.data.episode import CAMERA_KEYS, Sensed, Track, official_camera
from rtphys.data.hdf5_file import (
    GROUP,
    Rows,
    array,
    dataset,
    frame_of,
    group,
    note,
    open_read,
    packed,
    put,
    rows_at,
    text,
    texts,
    write_packed,
)
from rtphys.data.palette import PALETTE, coloured, row_of
from rtphys.senses import SENSES, Field, Sense
from rtphys.senses.depth import to_metres, to_mm
from rtphys.senses.segmentation import KINDS
from rtphys.senses.sense import Array, Encoding
from rtphys.senses.states import BodyPoses
from rtphys.senses.touch import Touch

T = TypeVar("T")

DECLARED = "senses"  # attribute of `rtphys/`: JSON list of the senses that a file holds
NAMES = f"{GROUP}/names"
# How a file holds a field in memory: the type, the axes that are added, there and back.
ENCODINGS: dict[
    Encoding,
    tuple[type | None, tuple[int, ...], Callable[[Array], Array], Callable[[Array], Array]],
] = {
    "as it is": (None, (), np.asarray, np.asarray),
    "mm": (np.float64, (), to_mm, to_metres),
    "palette": (np.uint8, (3,), coloured, row_of),
}


@dataclass(frozen=True)
class Stream:
    """T frames of a field of a sense, in a file."""

    sense: Sense
    field: Field
    camera: str  # empty but for a sense of every pixel
    rows: Rows

    def write(self, file: h5py.File, frames: Track) -> None:
        encode = ENCODINGS[self.field.encoding][2]
        if not self.field.packed:
            self.rows.put(file, encode(np.asarray(frames)), dict(self.field.notes))
            return
        # Frame by frame, so that no second copy of all is in memory.
        head, first = frames[:-1] if self.rows.last else frames, encode(frames[0])
        made = packed(file, self.rows.key, (len(head), *first.shape), first.dtype)
        made.attrs.update(dict(self.field.notes))
        for t, frame in enumerate(head):
            write_packed(made, t, encode(frame))
        if self.rows.last:
            put(file, self.rows.last, encode(frames[-1]))

    def read(self, file: h5py.File) -> Track:
        """All frames. Raises `KeyError`, `ValueError`."""
        if not self.field.packed:
            return ENCODINGS[self.field.encoding][3](self.rows.all(file))
        count = dataset(file, self.rows.key, frames=True).shape[0] + bool(self.rows.last)
        return [self.frame(file, t) for t in range(count)]

    def frame(self, file: h5py.File, index: int) -> Array:
        """One of them; negative ones count from the end. Raises `IndexError` too."""
        found = dataset(file, self.rows.key, frames=self.field.packed)
        count = found.shape[0] + bool(self.rows.last)
        at = index + count if index < 0 else index
        if not 0 <= at < count:
            raise IndexError(f"frame {index} of {count}")
        apart = at == found.shape[0]
        stored = array(file, self.rows.last) if apart else frame_of(found, at)
        return ENCODINGS[self.field.encoding][3](stored)

    def problems(
        self, file: h5py.File, sizes: Mapping[str, int], frames: int, chosen: Iterable[int]
    ) -> Iterator[str]:
        """What is wrong with type, shape and values. Raises `KeyError`, `ValueError`.

        Args:
            sizes: of a picture, and how many names of each kind there are.
            frames: T.
            chosen: of packed arrays, the frames whose values are looked at.
        """
        key, field = self.rows.key, self.field
        dtype, axes, _, _ = ENCODINGS[field.encoding]
        own, shape = np.dtype(dtype or field.dtype), (*field.sized(sizes), *axes)
        found = dataset(file, key, frames=field.packed)
        rows = frames - bool(self.rows.last)
        if (found.dtype, found.shape) != (own, (rows, *shape)):
            yield f"{key} is {found.dtype} {found.shape}, not {own} {(rows, *shape)}"
            return
        if self.rows.last:
            last = dataset(file, self.rows.last)
            if (last.dtype, last.shape) != (own, shape):
                yield f"{self.rows.last} is not as {key}"
                return
        for t in chosen if field.packed else (None,):
            place = key if t is None else f"{key} frame {t}"
            try:
                values = np.asarray(self.read(file) if t is None else self.frame(file, t))
            except ValueError as error:
                yield f"{place} {error}"
                continue
            if not np.isfinite(values).all():
                yield f"{place} holds a number that is not finite"
            elif values.size and values.min() < field.low:
                yield f"{place} holds a number below {field.low:g}"
            elif values.size and values.max() > field.high:
                yield f"{place} holds a number above {field.high:g}"
            elif field.ids and values.max() >= sizes[field.ids]:
                yield f"{place} holds an id without a name"
            elif reason := self.sense.problem(values):
                yield f"{place} {reason}"


def sense_streams(senses: Iterable[str], layout: str, cameras: Iterable[str]) -> Iterator[Stream]:
    """Every stream of senses, in the order in which files hold them."""
    for sense in (sense for name, sense in SENSES.items() if name in senses):
        for field in sense.fields:
            for camera in cameras if sense.scope == "pixel" else ("",):
                rows = rows_at(layout, *field.keys, camera, CAMERA_KEYS.get(camera, ""))
                yield Stream(sense, field, camera, rows)


def write_senses(file: h5py.File, sensed: Sensed, layout: str) -> None:
    """Writes all that was sensed, and the names in it; the group `rtphys/` is there."""
    file[GROUP].attrs[DECLARED] = json.dumps(list(sensed.senses))
    cameras = dict.fromkeys(camera for _, camera in sensed.tracks if camera)
    for stream in sense_streams(sensed.senses, layout, cameras):
        stream.write(file, sensed.tracks[stream.field.name, stream.camera])
    for kind in sorted(_kinds(sensed.senses)):
        names = list(sensed.names[kind])
        notes = {"unit": "JSON list"}
        if kind in KINDS:
            notes["colours"] = " ".join(bytes(colour).hex() for colour in PALETTE[: len(names)])
        put(file, f"{NAMES}/{kind}", json.dumps(names), notes)


def _kinds(senses: Iterable[str]) -> set[str]:
    return {kind for name in senses for field in SENSES[name].fields for kind in field.names}


def declared(file: h5py.File) -> tuple[str, ...]:
    """Senses that a file says it holds. Raises `KeyError`, `ValueError`, `BadFile`."""
    record = group(file, GROUP)
    return texts(note(record, DECLARED), file) if DECLARED in record.attrs else ()


def read_names(file: h5py.File, senses: Iterable[str]) -> dict[str, tuple[str, ...]]:
    """The names of each kind that senses have. Raises `KeyError`, `ValueError`, `BadFile`."""
    return {kind: texts(text(file, f"{NAMES}/{kind}"), file) for kind in _kinds(senses)}


def read_senses(file: h5py.File, layout: str, cameras: Iterable[str]) -> Sensed | None:
    """All that a file holds; None where it holds no senses. Raises as `declared`."""
    return _read(file, layout, cameras, senses) if (senses := declared(file)) else None


def _read(file: h5py.File, layout: str, cameras: Iterable[str], senses: tuple[str, ...]) -> Sensed:
    streams = sense_streams(senses, layout, cameras)
    tracks = {(one.field.name, one.camera): one.read(file) for one in streams}
    return Sensed(senses, tracks, read_names(file, senses))


@dataclass(frozen=True)
class SenseFile:
    """What an episode's file holds beyond colours, opened for each call.

    Every method raises `BadFile`, and `UnknownName` where the episode was recorded without.
    """

    path: Path
    layout: str
    cameras: tuple[str, ...]

    @property
    def senses(self) -> tuple[str, ...]:
        """Names of the senses that were recorded."""
        return self._opened(declared)

    def frame(self, field: str, frame: int, camera: str = "") -> Array:
        """One frame of a field of a sense (`rtphys.senses`), as it is in memory.

        Args:
            camera: whose; empty but for a sense of every pixel.
        """
        camera = official_camera(camera)
        streams = {one.field.name: one for one in sense_streams(SENSES, self.layout, (camera,))}
        if field not in streams:
            raise UnknownName("field of a sense", field, streams)
        sense = streams[field].sense
        if sense.scope == "pixel" and camera not in self.cameras:
            raise UnknownName("camera", camera, self.cameras, self.path)
        return self._opened(lambda file: streams[field].frame(file, frame), sense.name)

    def sensed(self, sense: str) -> Sensed:
        """All frames of a sense."""
        return self._opened(lambda file: _read(file, self.layout, self.cameras, (sense,)), sense)

    def depth(self, camera: str, frame: int) -> NDArray[np.float32]:
        """(H, W) [m] along the optical axis; 0 where nothing is."""
        return self.frame("depth", frame, camera)

    def ids(self, camera: str, frame: int, kind: str = "actor") -> NDArray[np.uint8]:
        """(H, W) id of the "actor" or of the "mesh" that each pixel shows; see `names`."""
        if kind not in KINDS:
            raise UnknownName("kind of id", kind, KINDS)
        return self.frame("actors" if kind == "actor" else "meshes", frame, camera)

    def names(self, kind: str = "actor") -> tuple[str, ...]:
        """What each id is called; 0 is the background."""
        if kind not in KINDS:
            raise UnknownName("kind of id", kind, KINDS)
        return self._opened(lambda file: read_names(file, ("segmentation",)), "segmentation")[kind]

    def cloud(self, frame: int) -> NDArray[np.float32]:
        """(1024, 6) of x y z [m] in the world and r g b 0..1, from the head camera."""
        return self.frame("cloud", frame)

    def bodies(self) -> BodyPoses:
        """Poses of every body at every frame."""
        found = self.sensed("states")
        return BodyPoses.of(found.tracks, found.names)

    def touch(self) -> Touch:
        """What the fingers felt in every frame."""
        found = self.sensed("touch")
        return Touch.of(found.tracks, found.names)

    def columns(self, sense: str) -> dict[str, Array]:
        """Columns (T,) for LeRobot of a sense that has some."""
        found = self.sensed(sense)
        frames = {field: np.asarray(track) for (field, _), track in found.tracks.items()}
        return SENSES[sense].exported(frames, found.names)

    def _opened(self, read: Callable[[h5py.File], T], sense: str = "") -> T:
        """What is read of the open file, which must hold a sense."""
        with open_read(self.path) as file:
            if sense and sense not in (known := declared(file)):
                raise UnknownName("sense", sense, known, self.path)
            return read(file)
