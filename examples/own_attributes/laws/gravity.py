"""Gravity: a body that falls from rest has the speed v(t) = g t."""

from rtphys.laws.lab import Lab, block, record, slope
from rtphys.laws.law import LawTest, Trial, Values, number
from rtphys.physics.handles import GRAVITY
from rtphys.physics.values import Value


def run(lab: Lab, value: Value, others: Values) -> list[Trial]:
    """Lets a block fall for 0.2 s and compares its acceleration with the law."""
    world = lab.world([block((0.03, 0.04, 0.05), (0, 0, 2))], {**others, "gravity": value})
    (body,) = world.bodies
    t, v = record(world, 50, lambda: body.component.linear_velocity[2])
    return [Trial("acceleration downwards", number(value), -slope(t, v), "m/s²", full=GRAVITY)]


LAW = LawTest(key="gravity", law="v(t) = g t", settings=(GRAVITY, 0.0, 1.62, 24.8), run=run)
