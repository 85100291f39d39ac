"""What verbs ask before anything moves: can an arm reach, and does it touch anything there?

Questions change neither the world nor the answer to another question; only inverse kinematics
draws from the episode's generator. Each question states what the other arm is about to do.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from rtphys.assets.action_layout import SIDES
from rtphys.core.poses import Array, Pose
from rtphys.expert.hands import Hands
from rtphys.expert.planner import DualArmPlanner
from rtphys.plan.collision import Obstacle
from rtphys.sim.rollout import Rollout
from rtphys.sim.room import TOP_HALF, WALL_AT, WALL_HALF
from rtphys.task.props import TABLE_TOP, Ball


@dataclass(frozen=True, eq=False)
class Intent:
    """Where an arm will be once the motions are done that its verbs have returned."""

    posture: Array  # (n,) [rad]
    around: str = ""  # the prop that it will then have between its fingers, and may touch


@dataclass(frozen=True, eq=False)
class Path:
    """Both ends of a sequence of straight lines of the ee."""

    start: Array  # (n,) posture at the first pose [rad]
    end: Array  # (n,) posture at the last pose [rad]


CLOSING = (0.67, 0.33)  # of the stroke: fingers are thicker than a third of it
_WALL = Obstacle("wall", np.array(WALL_HALF), Pose(WALL_AT))


class Feasibility:
    """Answers for both arms of one rollout. Poses are task-frame poses of the ee."""

    def __init__(self, rollout: Rollout, planner: DualArmPlanner, hands: Hands) -> None:
        self.rollout, self.planner, self.hands = rollout, planner, hands
        self.world, self.scene = rollout.world, rollout.scene
        self.felt_from = 0  # row of the recording with which the last `robot.do` began
        self._known: tuple[int, set[str]] | None = None  # step and loads at the last `refresh`

    def refresh(self) -> None:
        """Show the planner where table, wall, task objects and clutter are now.

        Left out are the loads, and balls: they roll away, or ride along in what is carried.
        """
        loads = set(self.hands.holding.values())
        now = self.rollout.steps, loads
        if now == self._known:  # nothing moves between two steps
            return
        x, y = self.world.plan.table.shift
        half = np.array(TOP_HALF)
        table = Obstacle("table", half, self.world.X_WT @ Pose((x, y, TABLE_TOP - half[2])))
        obstacles = [table, _WALL]
        for name, scene_object in self.world.scene_objects.items():
            if name in loads or isinstance(scene_object.prop, Ball):
                continue
            for link, parts in scene_object.parts.items():
                pose = scene_object.link_pose(link)
                obstacles += [Obstacle(name, part, pose) for part in parts]
        self.planner.checker.set_obstacles(obstacles)
        self._known = now

    def commanded(self, side: str) -> Array:
        """Commanded posture (n,) [rad]."""
        return self.world.robot.arm(side).target

    def commanded_ee(self, side: str) -> Pose:
        """Commanded pose of the ee."""
        ee = self.planner.kinematics[side].ee_pose(self.commanded(side))
        return self.world.to_task(ee)

    def posture(self, side: str, ee: Pose) -> Array | None:
        """A posture (n,) with this ee pose, on the branch nearest to the commanded one, or None."""
        return self.planner.posture(side, self.world.X_WT @ ee, self.commanded(side))

    def path(
        self, side: str, poses: Sequence[Pose], other: Intent | None, release: bool = False
    ) -> Path | None:
        """The path through these poses, if all are reachable without a change of branch and no
        link but a finger touches anything on the way.

        Args:
            other: as in `clear`.
            release: the hand opens at the end, where its fingers need room.
        """
        q = self.posture(side, poses[0])
        path = None if q is None else self._onward(side, q, poses[1:], other)
        if path is None or not release:
            return path
        both = {**self._postures(side, other), side: path.end}
        with self.planner.opening(side, 1.0):
            return None if self.planner.touched([both], leaving=False) else path

    def grasp(
        self, side: str, prop: str, poses: tuple[Pose, Pose], other: Intent | None
    ) -> Path | None:
        """The path from before a grasp to the grasp, if nothing is in the way.

        At the second pose, the fingers may touch the prop.
        """
        q = self.posture(side, poses[0])
        if q is None or not self.clear(side, q, other):
            return None
        path = self._onward(side, q, poses[1:], other)
        if path is None or not self.clear(side, path.end, other, prop):
            return None
        for share in CLOSING:  # nothing else may be between the fingers
            with self.planner.opening(side, share):
                if not self.clear(side, path.end, other, prop):
                    return None
        return path

    def _onward(
        self, side: str, q: Array, poses: Sequence[Pose], other: Intent | None
    ) -> Path | None:
        """From a posture through poses by straight lines."""
        line = self.planner.lines(side, q, [self.world.X_WT @ pose for pose in poses])
        if line is None:
            return None
        both = self._postures(side, other)
        touched = self.planner.touched({**both, side: row} for row in line)
        return None if touched else Path(q, line[-1])

    def follows(self, side: str, pose: Pose, alone: bool) -> bool:
        """Whether a hand can go straight to a pose; `alone`: and touches nothing on the way with
        the other arm where it is."""
        q = self.commanded(side)
        line = self.planner.lines(side, q, [self.world.X_WT @ pose])
        if line is None or not alone:
            return line is not None
        both = {s: self.commanded(s) for s in SIDES}
        return not self.planner.touched({**both, side: row} for row in line)

    def clear(self, side: str, q: Array, other: Intent | None, prop: str = "") -> bool:
        """Whether an arm touches nothing at a posture q (n,), but its fingers perhaps the prop.

        Args:
            other: of the other arm; None: it stays where it is with its load, and gets out of the
                way without one.
        """
        opposite = "right" if side == "left" else "left"
        postures = {**self._postures(side, other), side: q}
        around = other.around if other is not None else ""
        with self.planner.checker.ignoring((side, prop), (opposite, around)):
            return self.planner.clear(postures)

    def _postures(self, side: str, other: Intent | None) -> dict[str, Array]:
        """Where both arms are taken to be when one of them moves."""
        opposite = "right" if side == "left" else "left"
        postures = {s: self.commanded(s) for s in SIDES}
        if other is not None:
            postures[opposite] = other.posture
        elif not self.hands.holding.get(opposite):
            # Whether the other arm is in the way now does not matter: it can move first.
            postures[opposite] = self.world.robot.arm(opposite).limb.home
        return postures
