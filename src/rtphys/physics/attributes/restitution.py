"""Coefficient of restitution of task objects, table top and finger pads."""

from rtphys.physics.attribute import Attribute, Reading
from rtphys.physics.handles import Happened, World
from rtphys.physics.values import Interval, Value

STATED = 1.0  # [m/s] at which a label states its tolerance: a fall from 5 cm


def deviation_at(speed: float) -> float:
    """How far an impact at a speed [m/s] may be from the coefficient [1], up to one of 0.5.

    250 Hz: it falls up to one step too late, by which weight has made the body faster, and then
    sends it back from below the surface.
    """
    return 0.01 + 0.04 / speed


class Restitution(Attribute[World, float]):
    """Newton's coefficient [1], the same on task objects, table top and finger pads.

    PhysX averages the coefficients of two surfaces. Slower than the scene's bounce threshold
    (2 m/s by default, 0.2 m/s in every rtphys scene) nothing bounces.
    """

    key = "restitution"
    unit = "1"
    nominal = 0.0
    valid = Interval(0, 1)
    resolution = 1e-9
    what = "Newton's coefficient of object, table top and finger pads"
    scope = (
        "impacts on the table at 1 m/s, at other speeds 0.01 + 0.04 m/s / speed; "
        "on objects up to 0.5 m/s"
    )

    def deviation(self, value: Value) -> float:
        return deviation_at(STATED)

    def acted(self, happened: Happened) -> bool:
        return happened.impact

    def apply(self, target: World, value: float) -> None:
        for surface in target.surfaces:
            static, dynamic, _ = surface.materials()[0]
            surface.set_material(static, dynamic, value)

    def read(self, world: World) -> dict[str, Reading]:
        """Coefficient of each surface; a tuple for a surface with several."""
        out: dict[str, Reading] = {}
        for surface in world.surfaces:
            numbers = {e for _, _, e in surface.materials()}
            out[surface.name] = numbers.pop() if len(numbers) == 1 else tuple(sorted(numbers))
        return out
