"""Coefficient of restitution of task objects, table top and finger pads."""

from rtphys.physics.handles import Happened, Material
from rtphys.physics.pair import PairCoefficient
from rtphys.physics.values import Interval, Value

STATED = 1.0  # [m/s] at which a label states its tolerance: a fall from 5 cm


def deviation_at(speed: float) -> float:
    """How far an impact at a speed [m/s] may be from the coefficient [1], up to one of 0.5.

    250 Hz: it falls up to one step too late, by which weight has made the body faster, and then
    sends it back from below the surface.
    """
    return 0.01 + 0.04 / speed


class Restitution(PairCoefficient):
    """Newton's coefficient [1] of task objects with table top and finger pads.

    Slower than the scene's bounce threshold (2 m/s by default, 0.2 m/s in every rtphys scene)
    nothing bounces.
    """

    key = "restitution"
    unit = "1"
    nominal = 0.0
    valid = Interval(0, 1)
    by_prop = Interval(0, 0.5)  # beside a table with none its surface needs twice as much
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

    def numbers(self, material: Material) -> tuple[float, ...]:
        return material[2:]

    def changed(self, material: Material, number: float) -> Material:
        return material[0], material[1], number
