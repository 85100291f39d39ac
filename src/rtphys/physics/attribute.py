"""What a physical attribute is: a key, a unit, and how to write and read it."""

from abc import ABC, abstractmethod
from collections.abc import Mapping
from typing import ClassVar, Generic, Literal, TypeVar

import numpy as np

from rtphys.core.errors import BadValue
from rtphys.physics.handles import Blueprint, World
from rtphys.physics.interval import Interval
from rtphys.physics.values import Physics, Value, Vector

Target = TypeVar("Target", Blueprint, World)
Label = TypeVar("Label", float, Vector)
Reading = float | Vector


class Attribute(ABC, Generic[Target, Label]):
    """One way in which the physics of an episode can differ.

    A subclass is one file in `attributes/` (or in a user's library). It scales from the asset's
    own value, so applying twice is applying once.
    """

    key: ClassVar[str]  # the YAML key, the label in a dataset, the command line's name
    unit: ClassVar[str]  # of labels; `apply` converts to SI
    nominal: ClassVar[float | Vector | None]  # None: whatever the asset has
    valid: ClassVar[Interval]  # what the simulator can do; an override may go this far
    when: ClassVar[Literal["before_build", "after_build"]] = "after_build"
    size: ClassVar[int] = 1  # components; a distribution is drawn per component
    resolution: ClassVar[float] = 0.0  # absolute error that single precision leaves in `read`
    auxiliary: ClassVar[tuple[str, ...]] = ()  # other draws it needs, such as "camera_mode"
    what: ClassVar[str] = ""  # one phrase for tables

    def given(self, physics: Physics) -> "Attribute[Target, Label]":
        """This attribute, told the episode's auxiliary draws; most need none."""
        return self

    @abstractmethod
    def apply(self, target: Target, value: Label) -> None:
        """Put `value` in force in the blueprint or the built world."""

    @abstractmethod
    def read(self, world: World) -> dict[str, Reading]:
        """Place -> what the simulator now says, in this attribute's unit."""

    def expected(self, world: World, value: Label) -> dict[str, Reading]:
        """Place -> what `read` must return once `value` is in force."""
        return dict.fromkeys(self.read(world), value)

    def disagreements(self, world: World, value: Label) -> list[str]:
        """One sentence for each place where the simulator does not say `value`."""
        read, expected = self.read(world), self.expected(world, value)
        wrong = [f"{self.key} at {p}: read nothing" for p in expected.keys() - read.keys()]
        for place, found in read.items():
            want = expected.get(place)
            if want is None or not agree(found, want, self.resolution):
                wrong.append(f"{self.key} at {place}: read {found}, label says {want}")
        return sorted(wrong)

    def check(self, value: Value, where: str = "") -> None:
        """Refuse a value that the simulator cannot do.

        Raises:
            BadValue: wrong type, wrong number of components, or outside `valid`.
        """
        if value is None and self.nominal is None:
            return
        components = len(value) if isinstance(value, tuple) else 1
        if components != self.size or value not in self.valid:
            parts = f"{self.size} numbers, each" if self.size > 1 else "a number"
            unit = "" if self.unit == "1" else f" {self.unit}"
            raise BadValue(self.key, value, f"it is {parts} in {self.valid}{unit}", where)


def agree(a: Reading, b: Reading, resolution: float) -> bool:
    """Equal to 1e-6 relative, or to `resolution` absolute."""
    x, y = np.atleast_1d(np.asarray(a, float)), np.atleast_1d(np.asarray(b, float))
    return x.shape == y.shape and np.allclose(x, y, rtol=1e-6, atol=resolution)


Attributes = Mapping[str, Attribute]
