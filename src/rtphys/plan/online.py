"""Motions of a policy's actions: from rest to rest, or following targets that change."""

from math import ceil, sqrt

import numpy as np
from ruckig import InputParameter, OutputParameter, Result, Ruckig, Synchronization

from rtphys.core.errors import Infeasible
from rtphys.core.poses import Array
from rtphys.plan.blend import SAME_POINT
from rtphys.plan.path import TIME_STEP
from rtphys.plan.trajectory import JointLimits, Trajectory


class Straight:
    """The fastest motion from rest at q0 to rest at q1 on an exactly straight joint-space line.

    The optimum is known in closed form, so no search is made: accelerate, cruise, brake. (ruckig's
    Phase synchronisation would do for equal limits; with unequal ones it falls back to one that
    bends the line by up to 0.03 rad.)
    """

    def __init__(self, q0: Array, q1: Array, limits: JointLimits) -> None:
        """
        Args:
            q0: (d,) start [rad].
            q1: (d,) goal [rad].
            limits: of the d joints.

        Raises:
            ValueError: a number that is not finite.
        """
        self._q0, self._q1 = np.asarray(q0, float), np.asarray(q1, float)
        self._change = self._q1 - self._q0
        if not np.isfinite(self._change).all():
            raise ValueError("the start or goal of a motion is not finite")
        reach = np.abs(self._change)
        self._moves = bool(reach.max() > SAME_POINT)
        if self._moves:
            share = np.maximum(reach, 1e-12)  # of the joint that goes furthest, for each joint
            self._a = float((limits.acceleration / share).min())  # [1/s^2] of the way
            self._v = min(float((limits.velocity / share).min()), sqrt(self._a))  # [1/s]
        self.seconds = 1 / self._v + self._v / self._a if self._moves else 0.0
        self.steps = ceil(self.seconds / TIME_STEP - 1e-9)

    def sampled(self, steps: int) -> Trajectory:
        """The motion slowed evenly to last this many steps of 4 ms, at least `self.steps`.

        Returns:
            steps + 1 samples, from q0 to exactly q1; one alone when they are equal.
        """
        if not self._moves:
            return Trajectory(self._q1[None], np.zeros((1, len(self._q1))))
        pace = self.seconds / (steps * TIME_STEP)
        t = np.arange(steps + 1) * (TIME_STEP * pace)
        left = t[::-1]  # until the end
        a, v = self._a, self._v
        ramp = v / a  # [s]
        cruise = v * (t - ramp / 2)
        done = np.where(t < ramp, 0.5 * a * t * t, cruise)
        done = np.where(left < ramp, 1 - 0.5 * a * left * left, done)
        speed = np.minimum(np.minimum(t, left) * a, v) * pace
        q = self._q0 + done[:, None] * self._change
        q[-1] = self._q1
        return Trajectory(q, speed[:, None] * self._change)


class Tracker:
    """Follows a target that may change at any step, within the limits and without a jump.

    State carries over from step to step, so a policy's next action bends the motion instead of
    stopping it.
    """

    def __init__(self, q: Array, limits: JointLimits, dt: float = TIME_STEP) -> None:
        """Start at rest at q (d,)."""
        self._ruckig = Ruckig(len(limits.velocity), dt)
        self._wanted = InputParameter(len(limits.velocity))
        self._wanted.max_velocity = limits.velocity.tolist()
        self._wanted.max_acceleration = limits.acceleration.tolist()
        # Jerk stays unlimited: the limits are those of the path planner.
        self._wanted.synchronization = Synchronization.Time
        self._state = OutputParameter(len(limits.velocity))
        self._wanted.current_position = self._wanted.target_position = np.asarray(q, float).tolist()

    def follow(self, q: Array) -> None:
        """Set the target (d,) [rad], to be reached at rest.

        Raises:
            ValueError: a number that is not finite.
        """
        target = np.asarray(q, float)
        if not np.isfinite(target).all():
            raise ValueError(f"a target joint position is not finite: {target.tolist()}")
        self._wanted.target_position = target.tolist()

    def advance(self, steps: int) -> Trajectory:
        """The motion of the next steps: steps + 1 samples, from where it is now.

        Raises:
            Infeasible: "retime_failed", ruckig found no way to the target.
        """
        now = self._wanted
        q, qd = [now.current_position], [now.current_velocity]
        for _ in range(steps):
            result = self._ruckig.update(self._wanted, self._state)
            if result not in (Result.Working, Result.Finished):
                raise Infeasible("retime_failed", f"tracking: {result}")
            self._state.pass_to_input(self._wanted)
            q.append(self._state.new_position)
            qd.append(self._state.new_velocity)
        return Trajectory(np.array(q), np.array(qd))
