"""How strongly surfaces resist sliding."""

from rtphys.physics.attribute import Attribute, Reading
from rtphys.physics.handles import World
from rtphys.physics.interval import Interval


class Friction(Attribute[World, float]):
    """Coulomb coefficient of task objects, table top and finger pads alike.

    PhysX averages the two surfaces in contact, so only the same number on both makes the number of
    the pair. Static and dynamic are kept equal: unequal ones smear into each other.
    """

    key = "friction"
    unit = "1"
    nominal = None
    valid = Interval(0, 4)
    resolution = 1e-9
    what = "Coulomb coefficient of object, table top and finger pads"

    def apply(self, target: World, value: float) -> None:
        for surface in target.surfaces:
            _, _, restitution = surface.materials()[0]
            surface.set_material(value, value, restitution)

    def read(self, world: World) -> dict[str, Reading]:
        """At `<surface>` the coefficient; a surface that holds several numbers shows them all."""
        out: dict[str, Reading] = {}
        for surface in world.surfaces:
            numbers = {mu for s, d, _ in surface.materials() for mu in (s, d)}
            out[surface.name] = numbers.pop() if len(numbers) == 1 else tuple(sorted(numbers))
        return out
