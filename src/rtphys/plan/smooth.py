"""Straight motions and finger strokes from rest to rest whose jerk is limited, by ruckig.

Each is one coordinate on a line: how far the joint that moves most has come. ruckig calculates its
fastest course as a whole, before the motion; the other joints follow in proportion. So the line
stays exactly straight, also where ruckig's own phase synchronisation gives that up because the
limits of joints differ.
"""

from dataclasses import dataclass
from math import ceil, inf

import numpy as np
from ruckig import InputParameter, Ruckig, RuckigError
from ruckig import Trajectory as Course

from rtphys.core.errors import Infeasible
from rtphys.core.poses import Array
from rtphys.plan.trajectory import JointLimits, Trajectory

JERK = 100.0  # [rad/s^3] of the joint that moves most: cuRobo's official limit
# A motion takes at most this much longer than without a limit of jerk, and is then rounded up to
# whole steps. A short one, which would take longer under JERK, gets as little more as that allows.
LONGER = 1.15
_CLOSE_TO_LEAST = 1.01  # times the least jerk in the given time


@dataclass(frozen=True)
class _Way:
    """A distance to go from rest to rest, and its limits, in one unit of length."""

    distance: float
    velocity: float
    acceleration: float
    dt: float  # between samples [s]

    def course(self, jerk: float) -> Course:
        """The fastest course under a limit of jerk."""
        wanted, course = InputParameter(1), Course(1)
        wanted.target_position = [self.distance]
        wanted.max_velocity, wanted.max_acceleration = [self.velocity], [self.acceleration]
        wanted.max_jerk = [jerk]
        try:
            Ruckig(1).calculate(wanted, course)
        except RuckigError as problem:
            raise Infeasible("retime_failed", f"ruckig found no course for {self}") from problem
        return course

    def smooth_course(self) -> Course:
        """The course under JERK, or under the least jerk that keeps to LONGER."""
        allowed = ceil(LONGER * self.course(inf).duration / self.dt - 1e-9) * self.dt
        low = high = JERK
        course = self.course(high)
        while course.duration > allowed:
            low, high = high, 4 * high
            course = self.course(high)
        while high > _CLOSE_TO_LEAST * low:
            middle = (low * high) ** 0.5
            tried = self.course(middle)
            if tried.duration > allowed:
                low = middle
            else:
                high, course = middle, tried
        return course

    def sampled(self) -> tuple[Array, Array]:
        """Share of the way done, from 0 to 1, and its change [1/s], at each step (n + 1,)."""
        course = self.smooth_course()
        steps = max(ceil(course.duration / self.dt - 1e-9), 1)
        pace = course.duration / (steps * self.dt)  # slowed evenly to end on a step
        rows = [course.at_time(k * self.dt * pace) for k in range(steps + 1)]
        done = np.array([position for (position,), _, _ in rows]) / self.distance
        speed = np.array([velocity for _, (velocity,), _ in rows]) * (pace / self.distance)
        done[[0, -1]], speed[[0, -1]] = (0.0, 1.0), 0.0
        return done, speed


def straight(q0: Array, q1: Array, limits: JointLimits, dt: float) -> Trajectory:
    """The motion from rest at q0 (d,) to rest at q1 (d,) on a straight joint-space line.

    Args:
        q0: (d,) start [rad].
        q1: (d,) goal [rad], not the same.
        limits: of the d joints.
        dt: time between samples [s].

    Returns:
        Samples from q0 to exactly q1.

    Raises:
        Infeasible: "retime_failed", ruckig found no course.
    """
    change = q1 - q0
    reach = np.abs(change)
    most = float(reach.max())
    share = np.maximum(reach / most, 1e-12)
    velocity = float((limits.velocity / share).min())
    acceleration = float((limits.acceleration / share).min())
    done, speed = _Way(most, velocity, acceleration, dt).sampled()
    q = q0 + done[:, None] * change
    q[-1] = q1
    return Trajectory(q, speed[:, None] * change)


def stroke(g0: float, g1: float, seconds: float, dt: float) -> Array:
    """Gripper commands (n,) from opening g0 to g1, both included; one when they are equal.

    A stroke has no acceleration of its own to keep: it is as smooth as LONGER allows.

    Args:
        seconds: that the stroke would take at its greatest speed throughout [s].
    """
    if g0 == g1:
        return np.array([float(g1)])
    done, _ = _Way(abs(g1 - g0), abs(g1 - g0) / seconds, inf, dt).sampled()
    return g0 + done * (g1 - g0)
