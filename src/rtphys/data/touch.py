"""What an episode's fingers felt, in memory and in its file: forces, slip, friction."""

import json
from collections.abc import Mapping
from dataclasses import dataclass

import h5py
import numpy as np
from numpy.typing import NDArray

from rtphys.data.hdf5_file import array, group, note, put

UNITS = {
    "force": "N, x y z of the force on what a finger touches, mean of the frame; world",
    "normal": "N, along the contact's normal, mean of the frame",
    "normal_peak": "N, likewise, largest of the frame",
    "tangential": "N, across the contact's normal, mean of the frame",
    "tangential_peak": "N, likewise, largest of the frame",
    "slip": "m/s, of the object along the pad, mean of the frame",
    "slip_peak": "m/s, likewise, largest of the frame",
    "margin": "1, least of the frame of 1 - tangential / (friction * normal); 1: unloaded",
    "pressed": "N, normal force of a finger on each object, at the frame",
}


@dataclass(frozen=True, eq=False)
class Touch:
    """T frames of F fingers; a frame is the 60 ms that end in it, the first is empty."""

    fingers: tuple[str, ...]  # names of the links, left hand first
    objects: tuple[str, ...]  # P that some finger touched
    force: NDArray[np.float32]  # (T, F, 3); units in `UNITS`
    normal: NDArray[np.float32]  # (T, F), and so are those that follow
    normal_peak: NDArray[np.float32]
    tangential: NDArray[np.float32]
    tangential_peak: NDArray[np.float32]
    slip: NDArray[np.float32]
    slip_peak: NDArray[np.float32]
    margin: NDArray[np.float32]
    pressed: NDArray[np.float32]  # (T, F, P)

    def arrays(self) -> Mapping[str, NDArray[np.float32]]:
        """Every array by its key."""
        return {key: getattr(self, key) for key in UNITS}

    def problems(self, frames: int) -> list[str]:
        """What is wrong with the arrays for that many frames, one sentence each."""
        F, P = len(self.fingers), len(self.objects)
        more = {"force": (3,), "pressed": (P,)}
        found: list[str] = []
        for key, stored in self.arrays().items():
            wanted = (frames, F, *more.get(key, ()))
            if stored.dtype != np.float32 or stored.shape != wanted:
                found.append(f"touch/{key} is {stored.dtype} {stored.shape}, not float32 {wanted}")
            elif not np.isfinite(stored).all():
                found.append(f"touch/{key} holds a number that is not finite")
            elif key not in ("force", "margin") and stored.size and stored.min() < 0:
                found.append(f"touch/{key} is negative")
            elif key == "margin" and stored.size and stored.max() > 1:
                found.append(f"touch/{key} is above 1")
        return found


def write_touch(record: h5py.Group, touch: Touch) -> None:
    """Writes the group `touch`, with units as attributes."""
    made = record.create_group("touch")
    for key in ("fingers", "objects"):
        made.attrs[key] = json.dumps(list(getattr(touch, key)))
    for key, values in touch.arrays().items():
        put(made, key, values, {"unit": UNITS[key]})


def read_touch(record: h5py.Group) -> Touch:
    """Inverse of `write_touch`. Raises `KeyError`, `ValueError`."""
    stored = group(record, "touch")
    values = {key: array(stored, key) for key in UNITS}
    return Touch(_names(stored, "fingers"), _names(stored, "objects"), **values)


def _names(stored: h5py.Group, key: str) -> tuple[str, ...]:
    names = json.loads(note(stored, key))
    if not isinstance(names, list) or not all(isinstance(name, str) for name in names):
        raise ValueError(f"touch: {key} is no list of names")
    return tuple(names)
