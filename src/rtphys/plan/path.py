"""Time along a path: rest-to-rest motions inside velocity and acceleration limits."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray
from toppra.interpolator import AbstractGeometricPath

from rtphys.core.errors import Infeasible
from rtphys.core.poses import Array
from rtphys.plan.blend import BlendedPath
from rtphys.plan.smooth import straight
from rtphys.plan.speed import fastest
from rtphys.plan.trajectory import JointLimits, Trajectory

__all__ = ["JointLimits", "Trajectory", "retime"]

TIME_STEP = 1 / 250  # [s]
_GRID = 50  # TOPP-RA intervals over the whole path, at least two on every piece; 100: 0.2 % faster
_TURN_GRID = 8  # and this many more per unit change of direction: there the limits bend
_RETRIES = 8
_SLACK = 1.0005


@dataclass(frozen=True, eq=False)
class _Profile:
    """s(t) with constant acceleration on each interval."""

    t: Array  # (m + 1,) [s]
    s: Array  # (m + 1,) [rad]
    speed: Array  # (m + 1,) [rad/s]

    def at(self, t: Array) -> tuple[Array, Array]:
        """Length s and speed at times t (k,)."""
        k = np.searchsorted(self.t, t, side="right") - 1
        k = np.minimum(np.maximum(k, 0), len(self.t) - 2)
        begin, speed = self.t[k], self.speed[k]
        span = self.t[k + 1] - begin
        u = (self.speed[k + 1] - speed) / span
        r = np.minimum(np.maximum(t - begin, 0), span)
        return self.s[k] + r * (speed + 0.5 * r * u), speed + r * u


class _ToppraPath(AbstractGeometricPath):
    """The blended path as TOPP-RA wants to see it, in the joints (k,) that move."""

    def __init__(self, path: BlendedPath, joints: NDArray[np.intp]) -> None:
        self._path, self._joints = path, joints

    def __call__(self, path_positions: ArrayLike, order: int = 0) -> Array:
        return self._path.at(np.asarray(path_positions, float), order)[..., self._joints]

    @property
    def dof(self) -> int:
        return len(self._joints)

    @property
    def path_interval(self) -> Array:
        return self._path.breaks[[0, -1]]


def retime(waypoints: Array, limits: JointLimits, dt: float = TIME_STEP) -> Trajectory:
    """The motion along a polyline, from rest to rest.

    Two points give the exact straight line, its jerk limited (`rtphys.plan.smooth`). More give the
    polyline with rounded corners (`rtphys.plan.blend`, which bounds the deviation), timed by
    TOPP-RA. That is then slowed as a whole until the sampled motion keeps the limits exactly: on
    curves TOPP-RA oversteps accelerations between its grid points by up to 10 %.

    Args:
        waypoints: (n, d) joint positions [rad], n >= 1.
        limits: of the d joints.
        dt: time between samples [s].

    Returns:
        N samples. The first is waypoints[0], the last exactly waypoints[-1], both at rest. A
        path without length gives N = 1.

    Raises:
        Infeasible: "retime_failed", TOPP-RA or ruckig found no timing.
    """
    points = np.atleast_2d(np.asarray(waypoints, float))
    if not np.isfinite(points).all():
        raise ValueError("a waypoint is not finite")
    path = BlendedPath.through(points)
    if path is None:
        return Trajectory(points[-1:], np.zeros((1, points.shape[1])))
    if path.straight:
        return straight(points[0], points[-1], limits, dt)
    profile = _toppra(path, limits)
    seconds = float(profile.t[-1])
    s, qd = _at_steps(path, profile, seconds, dt)
    for _ in range(_RETRIES - 1):
        excess = _excess(qd, limits, dt)
        if excess <= 1 + 1e-9:
            break
        seconds *= excess * _SLACK
        s, qd = _at_steps(path, profile, seconds, dt)
    q = path.at(s)
    q[-1] = points[-1]
    return Trajectory(q, qd)


def _at_steps(
    path: BlendedPath, profile: _Profile, seconds: float, dt: float
) -> tuple[Array, Array]:
    """Lengths and joint velocities at each step of a motion that takes about `seconds`."""
    steps = max(int(np.ceil(seconds / dt - 1e-9)), 1)
    s, speed = _sampled(profile, steps, dt)
    return s, path.at(s, 1) * speed[:, None]


def _sampled(profile: _Profile, steps: int, dt: float) -> tuple[Array, Array]:
    """Length and speed at each step (steps + 1,) of the motion stretched to last steps * dt."""
    pace = float(profile.t[-1]) / (steps * dt)
    s, speed = profile.at(np.arange(steps + 1, dtype=float) * (dt * pace))
    speed[[0, -1]] = 0.0
    return s, speed * pace


def _excess(qd: Array, limits: JointLimits, dt: float) -> float:
    """By how much a motion must slow down: 1 when it keeps the limits."""
    v = np.abs(qd) / limits.velocity
    a = np.abs(qd[1:] - qd[:-1]) / dt / limits.acceleration
    return float(max(v.max(), np.sqrt(a.max())))


def _toppra(path: BlendedPath, limits: JointLimits) -> _Profile:
    spans = np.diff(path.breaks)
    turns = np.linalg.norm(path.bend, axis=1) * spans  # change of direction on each piece
    parts = np.ceil(np.maximum(_GRID * spans / path.length, 2 + _TURN_GRID * turns)).astype(int)
    inner = [
        begin + span * np.arange(n) / n
        for begin, span, n in zip(path.breaks, spans, parts, strict=False)
    ]
    # Every break is a grid point: the curvature jumps there.
    grid = np.concatenate([*inner, path.breaks[-1:]])
    joints = np.flatnonzero(np.abs(path.slope).max(axis=0) > 0)  # a still arm halves the work
    moving = JointLimits(limits.velocity[joints], limits.acceleration[joints])
    speed = fastest(_ToppraPath(path, joints), grid, moving)
    if speed is None:
        raise Infeasible("retime_failed", f"no timing for {len(path.start)} pieces")
    mean = (speed[1:] + speed[:-1]) / 2
    if (mean <= 0).any():
        raise Infeasible("retime_failed", "the path stands still on the way")
    return _Profile(np.concatenate([[0.0], np.cumsum(np.diff(grid) / mean)]), grid, speed)
