"""Motions of both arms: inverse kinematics, clear paths, and one time law for both."""

from collections.abc import Iterable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from functools import lru_cache
from itertools import pairwise

import numpy as np

from rtphys.assets.action_layout import SIDES
from rtphys.assets.embodiment import Embodiment
from rtphys.core.errors import Infeasible
from rtphys.core.poses import Array, Pose
from rtphys.plan.collision import CollisionChecker
from rtphys.plan.kinematics import arm_kinematics
from rtphys.plan.path import retime
from rtphys.plan.rrt import connect, straight_is_clear
from rtphys.plan.trajectory import TIME_STEP, JointLimits, Trajectory

LEAVE = 0.2  # [rad] of any joint within which a motion leaves what it touches at its start
LINE_SPEED = 0.7  # straight lines end in contact: a share of the usual pace


@dataclass(frozen=True, eq=False)
class ArmGoal:
    """Where one arm should go. Exactly one of `line` and `q` is set."""

    q: Array | None = None  # (n,) along any clear path
    line: tuple[Pose, ...] = ()  # straight lines of the ee through these world poses
    speed: float = 1.0
    seconds: float = 0.0  # take at least this long


@lru_cache(maxsize=4)
def _checker(embodiment: Embodiment) -> CollisionChecker:
    return CollisionChecker(embodiment)


class DualArmPlanner:
    """Plans for one episode; all chance comes from its generator."""

    def __init__(self, embodiment: Embodiment, rng: np.random.Generator) -> None:
        self.kinematics = arm_kinematics(embodiment)
        self.checker = _checker(embodiment)
        self.columns = dict(zip(SIDES, embodiment.action_layout.joints_alone, strict=True))
        self.limits = {limb.side: limb.limits for limb in embodiment.limbs}
        self._fastest = JointLimits(
            np.concatenate([limb.velocity for limb in embodiment.limbs]),
            np.concatenate([limb.acceleration for limb in embodiment.limbs]),
        )
        self._rng = rng
        # [m] each finger of a hand from closed, for collision checks
        self._open = {limb.side: limb.hand.finger_open for limb in embodiment.limbs}
        self.fingers = dict(self._open)
        self._tolerated: frozenset[str] = frozenset()
        self._start: dict[str, Array] = {}
        self.checker.reset()  # it is shared with earlier episodes

    def posture(self, side: str, ee: Pose, near: Array) -> Array | None:
        """A posture for a world ee pose on the branch nearest to `near`, or None."""
        return self.kinematics[side].solve_near(ee, near, self._rng)

    def lines(self, side: str, q: Array, poses: Sequence[Pose]) -> Array | None:
        """Postures (k, n) along straight lines from q through world ee poses, or None."""
        path = [np.asarray(q, float)[None]]
        for pose in poses:
            part = self.kinematics[side].line(path[-1][-1], pose)
            if part is None:
                return None
            path.append(part[1:])
        return np.vstack(path)

    def clear(self, postures: dict[str, Array]) -> bool:
        """Nothing touches, but near the start of the present motion what touched there."""
        fingers = self.fingers["left"], self.fingers["right"]
        if self.checker.clear(postures["left"], postures["right"], fingers):
            return True
        near = self._tolerated and all(
            np.abs(postures[side] - q).max() <= LEAVE for side, q in self._start.items()
        )
        return bool(near) and self._contacts(postures) <= self._tolerated

    @contextmanager
    def opening(self, side: str, share: float) -> Iterator[None]:
        """Within: questions are asked with the fingers of one hand this far open, of all."""
        before = self.fingers[side]
        self.fingers[side] = share * self._open[side]
        try:
            yield
        finally:
            self.fingers[side] = before

    def touched(self, way: Iterable[dict[str, Array]], leaving: bool = True) -> frozenset[str]:
        """What links that are no fingers first meet on a way of postures; empty if it is clear.

        Args:
            leaving: what touches at the start may, until it has parted; at the end it must have.
        """
        parting: frozenset[str] | None = None if leaving else frozenset()
        with self.checker.under(self.checker.rules._replace(links_only=True)):
            for postures in way:
                # The first question is the cheaper one.
                pairs = frozenset() if self.clear(postures) else self._contacts(postures)
                if parting is not None and pairs - parting:
                    return pairs - parting
                parting = pairs
        return parting or frozenset()

    def _contacts(self, postures: dict[str, Array]) -> frozenset[str]:
        fingers = self.fingers["left"], self.fingers["right"]
        return self.checker.contacts(postures["left"], postures["right"], fingers)

    def motion(self, start: dict[str, Array], goals: dict[str, ArmGoal], pace: float) -> Trajectory:
        """One motion of the named arms, both in the same time.

        Args:
            start: (n,) postures of both arms.
            goals: of the arms that move.
            pace: share of the usual speed.

        Returns:
            Trajectory over the joints of both arms, left then right.

        Raises:
            Infeasible: "unreachable", "no_path" or "retime_failed".
        """
        # What touches at the start (an object just released, the partner's load) may be left.
        self._tolerated, self._start = frozenset(), start
        if not self.clear(start):
            self._tolerated = self._contacts(start)
        try:
            waypoints = self._waypoints(start, goals)
        finally:
            self._tolerated = frozenset()
        speed = pace * min(LINE_SPEED * g.speed if g.line else g.speed for g in goals.values())
        motion = retime(waypoints, self._fastest.scaled(float(np.clip(speed, 0.02, 1.0))))
        least = max(goal.seconds for goal in goals.values()) / TIME_STEP
        if len(motion) >= least:
            return motion
        slower = self._fastest.scaled(max(speed * len(motion) / least, 1e-3))
        return retime(waypoints, slower)

    def _waypoints(self, start: dict[str, Array], goals: dict[str, ArmGoal]) -> Array:
        """A polyline of both arms (k, 2 n), clear where an arm may move freely."""
        paths, free = {}, sorted(side for side, goal in goals.items() if goal.q is not None)
        for side, goal in goals.items():
            if goal.q is not None:
                paths[side] = np.array([start[side], goal.q])
                continue
            path = self.lines(side, start[side], goal.line)
            if path is None:
                raise Infeasible("unreachable", f"the {side} hand cannot follow a straight line")
            paths[side] = path
        waypoints = _joined(paths, start)

        def by_side(q: Array) -> dict[str, Array]:
            return {side: q[columns] for side, columns in self.columns.items()}

        def is_clear(q: Array) -> bool:
            return self.clear(by_side(q))

        if not free and (pairs := self.touched(map(by_side, waypoints))):
            raise Infeasible("no_path", f"on a straight line: {', '.join(sorted(pairs))}")

        legs = pairwise(waypoints)
        if not free or all(straight_is_clear(a, b, is_clear) for a, b in legs):
            return waypoints

        # A detour by RRT-Connect in the joints of the arms that may move freely.
        if len(free) < len(paths):
            raise Infeasible("no_path", "a straight line of one arm meets the other arm")
        end = {side: paths[side][-1] if side in paths else start[side] for side in SIDES}
        if pairs := self._contacts(end) - self._tolerated:
            raise Infeasible("no_path", f"at the goal: {', '.join(sorted(pairs))}")
        base = np.concatenate([start[side] for side in SIDES])
        every = np.arange(len(base))
        columns = np.concatenate([every[self.columns[side]] for side in free])

        def full(q: Array) -> Array:
            both = base.copy()
            both[columns] = q
            return both

        goal = np.concatenate([end[side] for side in SIDES])[columns]
        limits = np.vstack([self.limits[side] for side in free])
        route = connect(base[columns], goal, lambda q: is_clear(full(q)), limits, self._rng)
        if route is None:
            raise Infeasible("no_path", f"no clear path for {' and '.join(free)}")
        return np.array([full(q) for q in route])


def _joined(paths: dict[str, Array], start: dict[str, Array]) -> Array:
    """Paths of both arms over a common parameter, (k, 2 n); an arm without a path keeps still."""
    shares = {}  # of the length done at each point
    for side, path in paths.items():
        steps = np.linalg.norm(np.diff(path, axis=0), axis=1)
        lengths = np.concatenate([[0.0], np.cumsum(steps)])
        moves = lengths[-1] >= 1e-9
        shares[side] = lengths / lengths[-1] if moves else np.linspace(0, 1, len(path))
    u = np.unique(np.round(np.concatenate(list(shares.values())), 9))
    columns = []
    for side in SIDES:
        if side in paths:
            columns += [np.interp(u, shares[side], joint) for joint in paths[side].T]
        else:
            columns += [np.full(len(u), q) for q in start[side]]
    return np.column_stack(columns)
