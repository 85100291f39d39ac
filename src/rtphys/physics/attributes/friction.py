"""Coulomb friction of task objects, table top and finger pads."""

from rtphys.physics.attribute import Attribute, Reading
from rtphys.physics.handles import World
from rtphys.physics.values import Interval


class Friction(Attribute[World, float]):
    """Coefficient of friction [1], the same on task objects, table top and finger pads.

    PhysX averages the coefficients of two surfaces in contact, so both must have the value for the
    pair to have it. Static and dynamic friction are equal: PhysX blends unequal ones.
    """

    key = "friction"
    unit = "1"
    nominal = 0.5
    valid = Interval(0, 4)
    resolution = 1e-9
    tolerance = 0.03
    scope = (
        "what stands on a face, on the table or an object; "
        "held, below a quarter of what the grip bears: creep of up to 8 mm/s"
    )
    what = "Coulomb coefficient of object, table top and finger pads"

    def apply(self, target: World, value: float) -> None:
        for surface in target.surfaces:
            _, _, restitution = surface.materials()[0]
            surface.set_material(value, value, restitution)

    def read(self, world: World) -> dict[str, Reading]:
        """Coefficient of each surface; a tuple for a surface with several."""
        out: dict[str, Reading] = {}
        for surface in world.surfaces:
            numbers = {mu for s, d, _ in surface.materials() for mu in (s, d)}
            out[surface.name] = numbers.pop() if len(numbers) == 1 else tuple(sorted(numbers))
        return out
