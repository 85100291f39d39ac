"""How much speed a collision gives back."""

from rtphys.physics.attribute import Attribute, Reading
from rtphys.physics.handles import World
from rtphys.physics.interval import Interval


class Restitution(Attribute[World, float]):
    """Newton's coefficient of task objects, table top and finger pads alike.

    PhysX averages the two surfaces and ignores approaches slower than the scene's bounce threshold
    (2 m/s by default, 0.2 m/s in every rtphys scene).
    """

    key = "restitution"
    unit = "1"
    nominal = 0.0
    valid = Interval(0, 1)
    resolution = 1e-9
    what = "Newton's coefficient of object, table top and finger pads"

    def apply(self, target: World, value: float) -> None:
        for surface in target.surfaces:
            static, dynamic, _ = surface.materials()[0]
            surface.set_material(static, dynamic, value)

    def read(self, world: World) -> dict[str, Reading]:
        """At `<surface>` the coefficient; a surface that holds several numbers shows them all."""
        out: dict[str, Reading] = {}
        for surface in world.surfaces:
            numbers = {e for _, _, e in surface.materials()}
            out[surface.name] = numbers.pop() if len(numbers) == 1 else tuple(sorted(numbers))
        return out
