"""Coulomb friction of task objects, table top and finger pads."""

from rtphys.physics.handles import Material
from rtphys.physics.pair import PairCoefficient
from rtphys.physics.values import Interval


class Friction(PairCoefficient):
    """Coefficient of friction [1] of task objects with table top and finger pads.

    Static and dynamic friction are equal: PhysX blends unequal ones.
    """

    key = "friction"
    unit = "1"
    nominal = 0.5
    valid = Interval(0, 4)
    by_prop = Interval(0, 2)  # beside a table with none its surface needs twice as much
    resolution = 1e-9
    tolerance = 0.03
    scope = (
        "what stands on a face, on the table or an object; "
        "held, below a quarter of what the grip bears: creep of up to 8 mm/s"
    )
    what = "Coulomb coefficient of object, table top and finger pads"

    def numbers(self, material: Material) -> tuple[float, ...]:
        return material[:2]

    def changed(self, material: Material, number: float) -> Material:
        return number, number, material[2]
