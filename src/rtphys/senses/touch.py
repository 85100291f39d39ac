"""Touch: what the fingers feel: forces, slip, friction."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from rtphys.senses.sense import Array, Arrays, Field, Names, Sense, Space

FINGERS = 4  # of the builtin robots, left hand first


def _field(name: str, unit: str, *more: int | str, low: float = 0.0, high: float = np.inf) -> Field:
    key, notes = f"rtphys/touch/{name}", (("unit", unit),)
    shape = ("finger", *more)
    return Field(name, (key, key), np.float32, shape, low, high, packed=False, notes=notes)


@dataclass(frozen=True, eq=False)
class Touch:
    """T frames of F fingers; a frame is the 60 ms that end in it, the first is empty."""

    fingers: tuple[str, ...]  # names of the links, left hand first
    objects: tuple[str, ...]  # P that some finger touched
    force: NDArray[np.float32]  # (T, F, 3); units in `TouchSense.fields`
    normal: NDArray[np.float32]  # (T, F), and so are those that follow
    normal_peak: NDArray[np.float32]
    tangential: NDArray[np.float32]
    tangential_peak: NDArray[np.float32]
    slip: NDArray[np.float32]
    slip_peak: NDArray[np.float32]
    margin: NDArray[np.float32]
    pressed: NDArray[np.float32]  # (T, F, P)

    @staticmethod
    def of(tracks: Mapping[tuple[str, str], Any], names: Names) -> "Touch":
        """From what a file holds."""
        arrays = {field.name: tracks[field.name, ""] for field in TouchSense.fields}
        return Touch(names["finger"], names["object"], **arrays)

    @property
    def kinds(self) -> Names:
        """Its names by kind, as a file has them."""
        return {"finger": self.fingers, "object": self.objects}

    def arrays(self) -> Arrays:
        """Every array by its field."""
        return {field.name: getattr(self, field.name) for field in TouchSense.fields}


class TouchSense(Sense):
    """`Touch`, from every step of the simulation."""

    name = "touch"
    scope = "world"
    size = 4 * 14 * 4
    exports = True
    fields = (
        _field(
            "force",
            "N, x y z of the force on what a finger touches, mean of the frame; world",
            3,
            low=-np.inf,
        ),
        _field("normal", "N, along the contact's normal, mean of the frame"),
        _field("normal_peak", "N, likewise, largest of the frame"),
        _field("tangential", "N, across the contact's normal, mean of the frame"),
        _field("tangential_peak", "N, likewise, largest of the frame"),
        _field("slip", "m/s, of the object along the pad, mean of the frame"),
        _field("slip_peak", "m/s, likewise, largest of the frame"),
        _field(
            "margin",
            "1, least of the frame of 1 - tangential / (friction * normal); 1: unloaded",
            low=-np.inf,
            high=1.0,
        ),
        _field("pressed", "N, normal force of a finger on each object, at the frame", "object"),
    )
    shown = ("normal", "tangential", "slip", "margin")  # of each finger, to policies

    def capture(self, source: Touch) -> Arrays:
        return source.arrays()

    def space(self) -> Space:
        return Space(-np.inf, np.inf, (FINGERS, 3 + len(self.shown)), np.float32)

    def observed(self, frame: Arrays) -> Array:
        """(4, 7) force x y z [N], normal, tangential [N], slip [m/s] and margin of each finger."""
        return np.column_stack([frame["force"], *(frame[part] for part in self.shown)])

    def exported(self, frames: Arrays, names: Names) -> dict[str, Array]:
        return {
            f"{finger}_{part}": frames[part][:, i]
            for i, finger in enumerate(names["finger"])
            for part in self.shown
        }
