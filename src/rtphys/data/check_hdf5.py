"""Checks an HDF5 file against its layout: keys, types, shapes, values, pictures."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path

import h5py
import numpy as np

from rtphys.core.errors import BadFile
from rtphys.data import jpeg
from rtphys.data.check_senses import check_senses
from rtphys.data.episode import FRAME_STEPS, Frames
from rtphys.data.hdf5_file import array, note, open_read, text
from rtphys.data.hdf5_legacy import legacy_streams, unshifted
from rtphys.data.hdf5_native import FORMAT_VERSION, native_sentences, native_streams, shifted
from rtphys.data.hdf5_record import read_record
from rtphys.data.hdf5_senses import CLOUDS, declared
from rtphys.data.streams import Streams

PERIOD = FRAME_STEPS / 250  # [s] between two frames
UNIT_QUATERNION = 1e-3  # how far a stored quaternion's length may be from 1


@dataclass(frozen=True)
class Hdf5Facts:
    """What a file holds, for comparison with the episode's other files."""

    problems: tuple[str, ...]
    frames: Frames | None = None
    seen: tuple[str, ...] = ()
    shapes: Mapping[str, tuple[int, int, int]] = field(default_factory=dict)  # of pictures
    senses: tuple[str, ...] = ()  # held beyond colours


def check_hdf5(path: Path, layout: str, *, decode: bool) -> Hdf5Facts:
    """Reads a whole file.

    Args:
        path: the file.
        layout: "native" or "legacy".
        decode: decode every picture; otherwise only its first and last bytes are looked at.
    """
    try:
        with open_read(path) as file:
            return _facts(file, layout, decode=decode)
    except BadFile as error:
        return Hdf5Facts((error.problem,))
    except (OSError, RuntimeError, ValueError, KeyError, TypeError) as error:
        return Hdf5Facts((f"not a whole {layout} file ({error})",))  # what HDF5 itself raises


def _facts(file: h5py.File, layout: str, *, decode: bool) -> Hdf5Facts:
    frames = read_record(file)
    seen: list[str] = []
    if layout == "legacy":
        streams_of = legacy_streams
        expected = unshifted(frames)
        if "pointcloud" in declared(file):  # which then are checked by themselves
            del expected[CLOUDS]
        problems = _same_arrays(file, expected)
    else:
        streams_of, seen = native_streams, native_sentences(file)
        problems = _same_arrays(file, shifted(frames)) + _constants(file)
    shapes = {}
    for name in frames.cameras:  # one at a time, so that the memory of one serves the next
        streams = streams_of(file, name)
        problems += _pictures(name, streams, len(frames), decode=decode)
        shapes[name] = streams.shape
    sensed, senses = check_senses(file, layout, frames, shapes, decode)
    problems += sensed
    return Hdf5Facts((*problems, *_motion(frames)), frames, tuple(seen), shapes, senses)


def _same_arrays(file: h5py.File, expected: Mapping[str, np.ndarray]) -> list[str]:
    problems = []
    for key, value in expected.items():
        try:
            stored = array(file, key)
        except KeyError:
            problems.append(f"{key} is missing")
            continue
        if (stored.dtype, stored.shape) != (value.dtype, value.shape):
            is_, should = f"{stored.dtype} {stored.shape}", f"{value.dtype} {value.shape}"
            problems.append(f"{key} is {is_}, not {should}")
        elif not np.array_equal(stored, value):
            problems.append(f"{key} differs from the recorded frames")
    return problems


def _constants(file: h5py.File) -> list[str]:
    seen = native_sentences(file)
    pairs = {
        "source_format": (note(file, "source_format"), "RoboTwin"),
        "data_format_version": (text(file, "data_format_version"), FORMAT_VERSION),
        "additional_info/frequency": (int(array(file, "additional_info/frequency")), FRAME_STEPS),
        "instruction": (text(file, "instruction"), seen[0]),
    }
    return [f"{key} is {is_!r}, not {want!r}" for key, (is_, want) in pairs.items() if is_ != want]


def _pictures(name: str, streams: Streams, frames: int, *, decode: bool) -> list[str]:
    problems = []
    if len(streams) != frames:
        problems.append(f"{name} has {len(streams)} pictures for {frames} frames")
    ends = (0, len(streams) - 1)
    for index, whole in enumerate(streams.whole()):
        if not whole:
            problems.append(f"{name} picture {index} is no whole JPEG stream")
            continue
        looked_at = decode or index in ends
        if looked_at and (reason := _undecodable(streams[index], streams.shape)):
            problems.append(f"{name} picture {index} {reason}")
    return problems


def _undecodable(stream: bytes, shape: tuple[int, int, int]) -> str:
    try:
        if (stated := jpeg.shape_of(stream)) != shape:
            return f"is {stated}, not {shape}"
        jpeg.decode(stream)
    except jpeg.BadImage:
        return "does not decode"
    return ""


def _motion(frames: Frames) -> list[str]:
    problems = []
    steps = np.diff(frames.time)
    if not np.allclose(steps, PERIOD, atol=1e-6):
        problems.append(f"frames are {steps.min():g} to {steps.max():g} s apart, not {PERIOD:g}")
    poses = {"left_endpose": frames.left_endpose, "right_endpose": frames.right_endpose}
    poses |= {f"object_poses/{name}": pose for name, pose in frames.object_poses.items()}
    for name, pose in poses.items():
        lengths = np.linalg.norm(pose[:, 3:], axis=1)
        if np.abs(lengths - 1).max() > UNIT_QUATERNION:
            problems.append(f"{name} holds quaternions that are not of unit length")
    for arm in ("left", "right"):
        opening = getattr(frames, f"{arm}_gripper")
        if opening.min() < 0 or opening.max() > 1:
            problems.append(f"{arm}_gripper leaves 0..1")
    return problems
