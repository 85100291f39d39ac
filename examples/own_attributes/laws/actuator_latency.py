"""Actuator latency: an arm begins to move this much later than one that obeys at once."""

import numpy as np

from rtphys.laws.lab import Lab, record
from rtphys.laws.law import LawTest, Trial, Values, number
from rtphys.physics.values import Value


def delay(lab: Lab, values: Values) -> float:
    """Time [ms] from a command of 0.2 rad until the third joint has gone half of the way."""
    arm = (world := lab.world([], values, steps=100)).robot.arms[0]
    home = list(arm.target)
    arm.drive([*home[:2], home[2] + 0.2, *home[3:]], [0.0] * len(home))
    t, q = record(world, 250, arm.measured)
    return float(1000 * t[np.argmax(q[:, 2] > home[2] + 0.1)])


def run(lab: Lab, value: Value, others: Values) -> list[Trial]:
    """Commands one joint, with and without the latency."""
    late, prompt = (delay(lab, {**others, "actuator_latency": x}) for x in (value, 0.0))
    return [Trial("delay", number(value), late - prompt, "ms", full=40.0)]


LAW = LawTest(key="actuator_latency", law="q(t) = q0(t - d)", settings=(0.0, 40.0, 400.0), run=run)
