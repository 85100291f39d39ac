"""Coefficients of two surfaces in contact: what each has, so that the pair has the label."""

from abc import abstractmethod
from dataclasses import dataclass, replace
from typing import Self

from rtphys.core.errors import Infeasible
from rtphys.physics.attribute import Attribute, Reading
from rtphys.physics.handles import Material, World
from rtphys.physics.reach import keys_of
from rtphys.physics.values import Physics


@dataclass(frozen=True)
class PairCoefficient(Attribute[World, float]):
    """A label is the coefficient of a prop with the table and with a finger pad.

    PhysX takes the mean of two surfaces. So table and pads have the smallest label of the scene,
    and a prop has `2 label - smallest`. Two props with labels a and b then have `a + b - smallest`.
    Where all labels are alike, so are all surfaces and pairs.
    """

    smallest: float | None = None  # label of the scene; None: the one that is applied

    def for_episode(self, physics: Physics) -> Self:
        return replace(self, smallest=min(physics.scalar(k) for k in keys_of(self.key, physics)))

    @abstractmethod
    def numbers(self, material: Material) -> tuple[float, ...]:
        """The material's numbers that this attribute writes."""

    @abstractmethod
    def changed(self, material: Material, number: float) -> Material:
        """The material with another number there."""

    def apply(self, target: World, value: float) -> None:
        """Raises `Infeasible`: "invalid_physics", no surface can make up the difference."""
        smallest, shared = self._smallest(value), {s.name for s in target.table_and_pads}
        own = 2 * value - smallest
        if own not in self.valid:
            needs = f"{self.key} {value:g} beside {smallest:g} needs a surface of {own:g}"
            raise Infeasible("invalid_physics", needs)
        for surface in target.surfaces:
            number = smallest if surface.name in shared else own
            surface.set_material(*self.changed(surface.materials()[0], number))

    def read(self, world: World) -> dict[str, Reading]:
        """Coefficient of each surface with table or pad; a tuple for a surface with several."""
        out: dict[str, Reading] = {}
        shared = {s.name for s in world.table_and_pads}
        for surface in world.surfaces:
            numbers = {n for material in surface.materials() for n in self.numbers(material)}
            if self.smallest is not None and surface.name not in shared:
                numbers = {(number + self.smallest) / 2 for number in numbers}
            out[surface.name] = numbers.pop() if len(numbers) == 1 else tuple(sorted(numbers))
        return out

    def expected(self, world: World, value: float) -> dict[str, Reading]:
        shared = {s.name for s in world.table_and_pads}
        smallest = self._smallest(value)
        return {n: smallest if n in shared else value for n in self.read(world)}

    def _smallest(self, value: float) -> float:
        return value if self.smallest is None else self.smallest


def of_two(a: float, b: float, smallest: float) -> float:
    """Coefficient of two props with labels a and b in a scene with this smallest label [1]."""
    return a + b - smallest
