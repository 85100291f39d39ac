"""What every motion must be: from rest to rest, within its limits."""

import numpy as np

from rtphys.plan.trajectory import JointLimits, Trajectory

DT = 1 / 250


def assert_legal(motion: Trajectory, limits: JointLimits) -> None:
    assert (motion.qd[[0, -1]] == 0).all()
    assert (np.abs(motion.qd) <= limits.velocity * (1 + 1e-6)).all()
    acceleration = np.diff(motion.qd, axis=0) / DT
    assert (np.abs(acceleration) <= limits.acceleration * (1 + 1e-6)).all()
    # Velocity is the derivative of position: the trapezoid rule is off by a dt^2 / 4 at most.
    moved = np.diff(motion.q, axis=0) - (motion.qd[1:] + motion.qd[:-1]) * DT / 2
    assert np.abs(moved).max() <= limits.acceleration.max() * DT**2 / 4 + 1e-9
