"""An episode's HDF5 file: either official layout, and the group `rtphys/` beside it.

Each array is stored once: where the official layout holds it exactly, otherwise below `rtphys/`,
which official readers ignore. So a legacy file keeps there what was measured; a native file, whose
official numbers are float32 and lack the last frame, commands, poses and that frame too.
"""

import json
import os
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import NamedTuple

import h5py
import numpy as np
from h5py import h5t  # pyright: ignore[reportAttributeAccessIssue]

from rtphys.core.errors import BadFile, UnknownName
from rtphys.data import files, jpeg
from rtphys.data.episode import (
    ARMS,
    CAMERA_KEYS,
    CAMERAS,
    FRAME_STEPS,
    CameraFrames,
    Frames,
    Sensed,
    official_camera,
)
from rtphys.data.hdf5_file import (
    DAMAGED,
    GROUP,
    MAX_REMEMBERED,
    Rows,
    array,
    arrays,
    build,
    dataset,
    group,
    names,
    note,
    open_read,
    put,
    rows_at,
    stamp,
    texts,
)
from rtphys.data.hdf5_senses import read_senses, write_senses
from rtphys.data.video import EncodedImages
from rtphys.senses.states import POSE

FORMAT_VERSION = "v1.0"
RECORD_VERSION = "2.0"
CHANNEL_ORDER = "standard RGB, each marked XPL-RGB1: cv2.imdecode returns BGR, Pillow RGB"
CLOUDS = "pointcloud"  # of the legacy layout, which always has it, with no column if not recorded
CALIBRATION = {  # of a camera -> where native files have it
    "intrinsic_cv": "vision/{view}/intrinsic_matrix",
    "extrinsic_cv": f"{GROUP}/cameras/{{camera}}/extrinsic_cv",
    # Named `extrinsics` but holding the OpenGL camera-to-world pose, as upstream has it.
    "cam2world_gl": "vision/{view}/extrinsics_matrix",
}


def _numbers(layout: str) -> dict[str, tuple[str, str]]:
    """Array of `Frames` -> where its T rows of float64 lie, and their unit."""
    found = {
        "time": (f"{GROUP}/time", "s"),
        "qpos": (f"{GROUP}/measured/qpos", "rad or m, measured"),
        "qvel": (f"{GROUP}/measured/qvel", "rad/s or m/s, measured"),
        # What the joint exerts along its axis, net of the robot's weight.
        "effort": (f"{GROUP}/measured/effort", "N m or N, measured"),
    }
    native = layout == "native"
    command = f"{GROUP}/command" if native else "joint_action"
    for arm in ARMS:
        found[f"{arm}_arm"] = (f"{command}/{arm}_arm", "rad, drive targets")
        found[f"{arm}_gripper"] = (f"{command}/{arm}_gripper", "1, 0 closed .. 1 open")
        pose = f"{GROUP}/endpose/{arm}" if native else f"endpose/{arm}_endpose"
        found[f"{arm}_endpose"] = (pose, POSE)
    return found


NUMBERS = {layout: _numbers(layout) for layout in ("native", "legacy")}


def _calibration(layout: str, camera: str) -> dict[str, Rows]:
    return {
        key: rows_at(layout, f"observation/{camera}/{key}", native, camera, CAMERA_KEYS[camera])
        for key, native in CALIBRATION.items()
    }


def _streams(layout: str, camera: str) -> Rows:
    native = f"vision/{CAMERA_KEYS[camera]}/colors"
    return rows_at(layout, f"observation/{camera}/rgb", native, camera, "")


def derived(frames: Frames, layout: str) -> dict[str, np.ndarray]:
    """Official arrays that say once more, or less exactly, what others hold; by path in the file.

    Native: R = T - 1 rows; state row t is frame t, action row t is frame t + 1.
    """
    found: dict[str, np.ndarray] = {}
    if layout == "native":
        for part, rows in (("state", slice(0, -1)), ("action", slice(1, None))):
            for arm in ARMS:
                opening = np.asarray(getattr(frames, f"{arm}_gripper"))[:, None]  # (R, 1), not (R,)
                found[f"{part}/{arm}_arm_joint_states"] = getattr(frames, f"{arm}_arm")[rows]
                found[f"{part}/{arm}_ee_joint_states"] = opening[rows]
                found[f"{part}/{arm}_ee_poses"] = getattr(frames, f"{arm}_endpose")[rows]
        return {key: np.asarray(value, np.float32) for key, value in found.items()}
    for arm in ARMS:
        found[f"endpose/{arm}_gripper"] = np.asarray(getattr(frames, f"{arm}_gripper"), np.float64)
    return {**found, "joint_action/vector": frames.vector, CLOUDS: np.zeros((len(frames), 0))}


def episode_bytes(
    layout: str,
    frames: Frames,
    images: EncodedImages,
    sentences: Sequence[str],
    sensed: Sensed | None = None,
) -> bytes:
    """The file's bytes. `sentences`: one at least for the native layout; legacy files have none."""

    def fill(file: h5py.File) -> None:
        record = file.create_group(GROUP)
        record.attrs["record_version"] = RECORD_VERSION
        record.attrs["joint_names"] = json.dumps(list(frames.joint_names))
        record.attrs["stages"] = json.dumps(list(frames.stages))
        for name, (key, unit) in NUMBERS[layout].items():
            values = np.asarray(getattr(frames, name), np.float64)
            put(file, key, values, {"unit": unit} if key.startswith(GROUP) else None)
        for name, poses in sorted(frames.object_poses.items()):
            put(record, f"object_poses/{name}", np.asarray(poses, np.float64), {"unit": POSE})
        touch = {"unit": "bool", "columns": "left gripper, right gripper"}
        for name, touched in sorted(frames.contacts.items()):
            put(record, f"contacts/{name}", np.asarray(touched, bool), touch)
        put(record, "stage", np.asarray(frames.stage, np.int32), {"unit": "index into stages"})
        for name, camera in sorted(frames.cameras.items()):
            for key, rows in _calibration(layout, name).items():
                notes = {"unit": "m; world to camera, OpenCV axes"} if GROUP in rows.key else None
                rows.put(file, np.asarray(getattr(camera, key), np.float32), notes)
        for key, value in derived(frames, layout).items():
            if key != CLOUDS or sensed is None or CLOUDS not in sensed.senses:
                put(file, key, value)
        for name, streams in images.jpegs.items():
            rows = _streams(layout, name)
            # NUL padding is safe because JPEG ends in FF D9.
            head = streams[:-1] if rows.last else streams
            notes = {"channel_order": CHANNEL_ORDER} if layout == "native" else None
            put(file, rows.key, np.array(head, f"S{max(map(len, head))}"), notes)
            if rows.last:
                put(file, rows.last, np.bytes_(streams[-1]), notes)
                shape = np.array(jpeg.shape_of(streams[0]), np.int32)
                put(file, rows.key.replace("colors", "shape"), shape)
        if layout == "native":
            file.attrs.update(source_format="RoboTwin", source_path="native_collection")
            put(file, "data_format_version", FORMAT_VERSION)
            put(file, "instruction", sentences[0])  # which several readers need
            put(file, "instructions", json.dumps(list(sentences), ensure_ascii=False))
            # RoboTwin writes its `save_freq` here: control steps a frame.
            put(file, "additional_info/frequency", np.int32(FRAME_STEPS))
        if sensed is not None:
            write_senses(file, sensed, layout)

    return build(fill)


def _cameras(file: h5py.File, layout: str) -> list[str]:
    return names(group(file, f"{GROUP}/cameras" if layout == "native" else "observation"))


def read_frames(file: h5py.File, layout: str) -> Frames:
    """Raises `KeyError`, `ValueError`, `BadFile`: arrays are missing, or contradict each other."""
    record, seen = group(file, GROUP), _cameras(file, layout)
    if strange := set(seen) - set(CAMERAS):
        raise KeyError(f"{min(strange)} is no camera")
    frames = Frames(
        **{name: array(file, key) for name, (key, _) in NUMBERS[layout].items()},
        stage=array(record, "stage"),
        joint_names=texts(note(record, "joint_names"), file),
        stages=texts(note(record, "stages"), file),
        object_poses=arrays(record, "object_poses"),
        contacts=arrays(record, "contacts"),
        cameras={
            name: CameraFrames(
                **{key: rows.all(file) for key, rows in _calibration(layout, name).items()}
            )
            for name in sorted(seen)
        },
    )
    frames.check(file.filename)
    return frames


class Pictures(NamedTuple):
    """Of one camera."""

    streams: list[bytes]  # T of them
    shape: tuple[int, int, int]  # of each (H, W, 3)


def read_pictures(file: h5py.File, layout: str, camera: str) -> Pictures:
    """The pictures of a camera, by its official name. Raises `BadFile`."""
    rows = _streams(layout, camera)
    try:
        found = array(file, rows.key)
        if found.ndim != 1 or found.dtype.kind != "S" or found.itemsize < 2:
            raise ValueError(f"{rows.key} holds {found.dtype} {found.shape}, no picture streams")
        streams = found.tolist()  # without the NUL padding
        if not rows.last:
            return Pictures(streams, jpeg.shape_of(streams[0]))
        height, width, depth = array(file, rows.key.replace("colors", "shape")).tolist()
        last = array(file, rows.last).item()
        if not isinstance(last, bytes):
            raise ValueError(f"{rows.last} holds no picture stream")
    except (*DAMAGED, IndexError, jpeg.BadImage) as error:
        raise BadFile(file.filename, f"has no pictures of {camera} ({error})") from error
    return Pictures([*streams, last], (height, width, depth))


def read_episode(path: Path, layout: str) -> tuple[Frames, EncodedImages, Sensed | None]:
    """Frames, picture streams (no video) and senses. Raises `BadFile`."""
    with open_read(path) as file:
        frames = read_frames(file, layout)
        jpegs = {name: read_pictures(file, layout, name).streams for name in frames.cameras}
        return frames, EncodedImages(jpegs), read_senses(file, layout, [*frames.cameras])


# ---- one picture without the others --------------------------------------------------------------


class Span(NamedTuple):
    """Where streams lie in a file, one behind the other."""

    offset: int  # [bytes]
    size: int  # [bytes] of each
    rows: int


_spans: dict[tuple[tuple[int, ...], str], list[Span]] = {}  # by a file's stamp and camera


def _span(file: h5py.File, key: str) -> Span:
    """Raises `ValueError`, `KeyError`: they are no streams."""
    found = dataset(file, key)
    kind, shape = found.get_type(), found.shape
    if kind.get_class() != h5t.STRING or kind.is_variable_str() or len(shape) > 1:
        raise ValueError(f"{key} holds no picture streams")
    return Span(found.get_offset(), kind.get_size(), shape[0] if shape else 1)


@dataclass(frozen=True)
class EpisodeFile:
    """An episode's HDF5 file, opened for each call."""

    path: Path
    layout: str

    def frames(self) -> Frames:
        """Raises `BadFile`."""
        with open_read(self.path) as file:
            return read_frames(file, self.layout)

    def streams(self, camera: str) -> list[bytes]:
        """The T picture streams of a camera. Raises `UnknownName`, `BadFile`."""
        camera = official_camera(camera)
        with open_read(self.path) as file:
            self._check(file, camera)
            return read_pictures(file, self.layout, camera).streams

    def stream(self, camera: str, frame: int) -> bytes:
        """One picture stream; negative frames count from the end.

        Opening an HDF5 file costs more than decoding a picture. So the first reading remembers
        where all streams lie, and later ones of the unchanged file read those bytes alone.

        Raises:
            UnknownName, BadFile: as `streams`.
            IndexError: no such frame.
        """
        camera = official_camera(camera)
        with files.open_binary(self.path) as opened:
            key = stamp(os.fstat(opened.fileno())), camera
            if (spans := _spans.get(key)) is None:
                with open_read(self.path) as file:
                    self._check(file, camera)
                    rows = _streams(self.layout, camera)
                    spans = [_span(file, one) for one in (rows.key, rows.last) if one]
                if len(_spans) < MAX_REMEMBERED:
                    _spans[key] = spans
            count = sum(span.rows for span in spans)
            index = frame + count if frame < 0 else frame
            if not 0 <= index < count:
                raise IndexError(f"frame {frame} of {count}")
            first, last = spans[0], spans[-1]
            offset, size = first.offset + index * first.size, first.size
            if index >= first.rows:  # the one that lies apart
                offset, size = last.offset, last.size
            return os.pread(opened.fileno(), size, offset).rstrip(b"\0")

    def _check(self, file: h5py.File, camera: str) -> None:
        if camera not in (known := _cameras(file, self.layout)):
            raise UnknownName("camera", camera, known, self.path)
