"""The interface of a physical attribute: its key and unit, how to write it and how to read it."""

from abc import ABC, abstractmethod
from collections.abc import Collection, Mapping
from typing import Any, ClassVar, Generic, Literal, TypeVar

import numpy as np

from rtphys.core.errors import BadValue
from rtphys.physics.handles import Blueprint, World
from rtphys.physics.interval import Interval
from rtphys.physics.values import Physics, Value, Vector

Target = TypeVar("Target", Blueprint, World)
Label = TypeVar("Label", float, Vector)
Reading = float | Vector
Part = Literal["bodies", "joints"]  # dynamic bodies, and joints of articulated task objects


class Attribute(ABC, Generic[Target, Label]):
    """One physical quantity that can vary between episodes, such as friction.

    Each subclass has a file of its own in `attributes/` or in a user's library. `apply` starts from
    the asset's nominal value, never from the current one, so that repeating it changes nothing.
    """

    key: ClassVar[str]  # name in domain files, in dataset labels and on the command line
    unit: ClassVar[str]  # of values and labels; `apply` converts to SI
    nominal: ClassVar[float | Vector | None]  # None: the asset's own value
    valid: ClassVar[Interval]  # range of the simulator; a held value may go so far
    when: ClassVar[Literal["before_build", "after_build"]] = "after_build"
    # Keys of attributes that write the same quantity and must have written it before this one does.
    applied_after: ClassVar[tuple[str, ...]] = ()
    size: ClassVar[int] = 1  # number of components, each drawn on its own
    resolution: ClassVar[float] = 0.0  # absolute error of `read` in single precision
    # [1] Share of the value by which the world may differ: what `physics audit` resolves.
    tolerance: ClassVar[float] = 1e-3
    auxiliary: ClassVar[tuple[str, ...]] = ()  # keys of further draws that it needs
    acts_on: ClassVar[Part | None] = None  # a world without any leaves it without effect
    what: ClassVar[str] = ""  # a phrase that describes it in tables

    def for_episode(self, physics: Physics) -> "Attribute[Target, Label]":
        """This attribute with the auxiliary draws of one episode filled in; most need none."""
        return self

    def acts(self, parts: Collection[Part], value: Value) -> bool:
        """Whether it changes anything where it has this value; if not, it is no factor.

        Args:
            parts: what the episode's world has.
        """
        return self.acts_on is None or self.acts_on in parts

    @abstractmethod
    def apply(self, target: Target, value: Label) -> None:
        """Write `value` (in `unit`) to the blueprint or to the built world."""

    @abstractmethod
    def read(self, world: World) -> dict[str, Reading]:
        """Name of each body, surface or joint -> its value in the simulator now, in `unit`."""

    def expected(self, world: World, value: Label) -> dict[str, Reading]:
        """What `read` must return after `apply(value)`."""
        return dict.fromkeys(self.read(world), value)

    def disagreements(self, world: World, value: Label) -> list[str]:
        """One sentence for each name at which the simulator's value differs from `value`."""
        read, expected = self.read(world), self.expected(world, value)
        wrong = [f"{self.key} at {n}: read nothing" for n in expected.keys() - read.keys()]
        for name, reading in read.items():
            want = expected.get(name)
            if want is None or not agree(reading, want, self.resolution):
                wrong.append(f"{self.key} at {name}: read {reading}, label says {want}")
        return sorted(wrong)

    def deviation(self, value: Value) -> float | None:
        """How far the world may be from the label `value`, in `unit`; None for the asset's own.

        What independent experiments in whole worlds found (docs/physics.md), not what `read` says.
        """
        if value is None:
            return None
        size = float(np.abs(np.asarray(value, float)).max())
        return max(self.tolerance * size, self.resolution)

    def check(self, value: Value, where: str = "") -> None:
        """Raise unless the simulator can have this value.

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
    """Whether two readings are equal within 1e-6 (relative) or `resolution` (absolute)."""
    x, y = np.atleast_1d(np.asarray(a, float)), np.atleast_1d(np.asarray(b, float))
    return x.shape == y.shape and np.allclose(x, y, rtol=1e-6, atol=resolution)


# Attributes of both stages and both label types stand in one table.
AnyAttribute = Attribute[Any, Any]
Attributes = Mapping[str, AnyAttribute]
