"""The verbs of one arm (`rtphys.task.arm.Arm`): from words to steps, with feasible poses."""

from collections.abc import Sequence
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from rtphys.core.errors import Infeasible
from rtphys.core.poses import Pose, axis_angle
from rtphys.expert.grasp import STRAIGHT_DOWN, Grasp, candidates
from rtphys.expert.place import Held, goals
from rtphys.task.arm import Aim, Follow, Grip, Home, Line, Motion, Placing, Reach, Shift, Step, Wait
from rtphys.task.props import TABLE_TOP

if TYPE_CHECKING:
    from rtphys.expert.robot import ExpertRobot

Posture = tuple[float, ...]  # (n,) [rad]
Placed = tuple[Pose, Pose, Posture]  # hand poses before and at a placement, the first's posture
LEAN = 0.006  # [m] past the first touch: at a replay's slower pace a load hangs a little higher
ROOM = 0.01  # [m] round a load that is brought into something: servos lag, and loads sag
TURNED = 0.35  # [rad] of a load in its hand that keeps it from being placed as it was meant to be
HANGING = 0.05  # [m] by which it may then hang lower
MOST_AIMED = 30  # graspable ways that are tested for what they allow later
_PLACE_YAWS = (0.0, 0.4, -0.4, 0.8, -0.8, 1.57, -1.57)  # [rad] tried where the yaw is free


class ExpertArm:
    """Verbs of one arm. Everything that depends on the moment is read when the verb is said."""

    def __init__(self, robot: "ExpertRobot", side: str) -> None:
        self.robot, self.side = robot, side

    def ee(self) -> Pose:
        return self.robot.commanded_ee(self.side)

    # ---- taking hold -----------------------------------------------------------------------------

    def grasp(
        self,
        prop: str,
        contacts: Sequence[int] = (),
        pre: float = 0.1,
        depth: float = 0.0,
        grip: float = 0.0,
        aim: Aim | None = None,
    ) -> Motion:
        way, posture = self._feasible_grasp(prop, contacts, (pre, depth), aim)
        steps = (
            Reach((way.backed_off(pre),), posture),
            Line(way.backed_off(depth)),
            Grip(grip, holds=prop),
        )
        return self._motion(f"grasp {prop}", *steps)

    def hover(
        self, prop: str, contact: int = 0, gap: float = 0.1, straight_down: bool = False
    ) -> Motion:
        point = self.robot.scene.contact(prop, contact)
        if straight_down:
            back = Pose(point.p + np.array([0, 0, self.robot.hand.tcp + gap]), STRAIGHT_DOWN)
            return self._motion(f"hover {prop}", Reach((back,)))
        # Unlike a grasp, a hover must not be shifted away from thin things: nothing is held.
        ways = candidates([(contact, point)], self.side, -np.inf, self.robot.hand)
        self.robot.refresh()
        poses = tuple(way.backed_off(gap) for way in ways)
        return self._motion(f"hover {prop}", Reach(poses))

    def _feasible_grasp(
        self, prop: str, contacts: Sequence[int], depths: tuple[float, float], aim: Aim | None
    ) -> tuple[Grasp, Posture]:
        self.robot.refresh()
        scene = self.robot.scene
        known = len(self.robot.world.object(prop).contact_points)
        numbers = list(contacts) or list(range(known))
        if not numbers:
            raise Infeasible("ungraspable", f"{prop} has no contact points")
        points = [(i, scene.contact(prop, i)) for i in numbers]
        points += self._around(prop, points)
        first = None
        tried = 0
        for way in candidates(points, self.side, TABLE_TOP, self.robot.hand):
            before, at = (way.backed_off(d) for d in depths)
            q = self.robot.grasp_posture(self.side, prop, before, at)
            if q is None:
                continue
            found = way, tuple(q.tolist())
            if aim is None or self._allows(prop, at, aim):
                return found
            first, tried = first or found, tried + 1
            if tried >= MOST_AIMED:
                break
        if first is None:
            raise Infeasible("unreachable", f"no contact point of {prop} for the {self.side} hand")
        return first

    def _around(self, prop: str, points: list[tuple[int, Pose]]) -> list[tuple[int, Pose]]:
        """Contact points between those at 45 deg of a round thing, which lies as it rolled."""
        axis = self.robot.world.object(prop).prop.rolling_axis
        if axis is None:
            return []
        X_TP = self.robot.scene.pose(prop)
        turn = Pose((0, 0, 0), axis_angle(axis, np.pi / 8))
        return [(i, X_TP @ turn @ X_TP.inverse() @ point) for i, point in points]

    def _allows(self, prop: str, hand: Pose, aim: Aim) -> bool:
        """Whether a thing grasped at this hand pose can be placed as aimed."""
        with self.robot.supposing(self.side):
            held = self._held(prop, hand, aim.point)
            return self._placement(held, aim.target, aim.how) is not None

    # ---- letting go ------------------------------------------------------------------------------

    def place(
        self, prop: str, target: Pose, point: int | None = None, how: Placing | None = None
    ) -> Motion:
        how = how or Placing()
        # The commanded hand, not the measured one: the load's droop is then in the grasp, and the
        # thing itself arrives where it should.
        found = self._placement(self._held(prop, self.ee(), point), target, how)
        if self.robot.hands.turned(self.side) > TURNED:
            found = self._despite_turn(prop, found, (target, point, how))
        if found is None:
            raise Infeasible("unreachable", f"the {self.side} hand cannot place {prop} there")
        before, after, posture = found
        steps: list[Step] = [Reach((before,), posture, ROOM if how.clear else 0.0, how.speed)]
        if how.pre != how.gap:
            steps.append(Line(after, until=how.until))
        if how.until:
            way = after.p - before.p
            lean = LEAN * way / max(float(np.linalg.norm(way)), 1e-9)
            steps += [Shift((float(lean[0]), float(lean[1]), float(lean[2]))), Wait(0.12)]
        if how.release:
            steps.append(Grip(1.0, releases=prop))
        return self._motion(f"place {prop}", *steps)

    def _held(self, prop: str, hand: Pose, point: int | None) -> Held:
        scene = self.robot.scene
        functional = None if point is None else scene.functional(prop, point)
        return Held(self.side, hand, scene.pose(prop), functional)

    def _despite_turn(
        self, prop: str, found: Placed | None, meant: tuple[Pose, int | None, Placing]
    ) -> Placed:
        """A way to place a load that hangs askew: as it hangs, or else as it was grasped."""
        if found is not None and self.robot.clear_at(self.side, np.array(found[2]), prop):
            return found
        target, point, how = meant
        higher = replace(how, pre=how.pre + float(np.copysign(HANGING, how.pre)))
        found = self._placement(self._as_grasped(prop, point), target, higher)
        if found is None or not self.robot.clear_at(self.side, np.array(found[2]), prop):
            raise Infeasible("slipped", f"{prop} has turned in the {self.side} hand, past placing")
        return found

    def _as_grasped(self, prop: str, point: int | None) -> Held:
        """The load as it was when the hand closed; what it stands on will turn it back to that."""
        hand, scene = self.ee(), self.robot.scene
        thing = hand @ self.robot.hands.grasped[self.side]
        X_TP = scene.pose(prop).inverse()
        functional = None if point is None else thing @ X_TP @ scene.functional(prop, point)
        return Held(self.side, hand, thing, functional)

    def _placement(self, held: Held, target: Pose, how: Placing) -> Placed | None:
        """Hand poses before and at the placement and the first one's posture, or None."""
        yaws = how.yaws
        if yaws == (0.0,) and how.mode in ("free", "auto"):
            yaws = _PLACE_YAWS
        for yaw in yaws:
            before, after = goals(held, target, how, yaw)
            q = self.robot.path_posture(self.side, (before, after))
            if q is None or (how.clear and not self.robot.way_is_clear(self.side, q)):
                continue
            return before, after, tuple(q.tolist())
        return None

    # ---- moving ----------------------------------------------------------------------------------

    def shift(self, x: float = 0, y: float = 0, z: float = 0, turn: Sequence[float] = ()) -> Motion:
        return self._motion("shift", Shift((x, y, z), turn=tuple(turn)))

    def lift(self, z: float, speed: float = 1.0) -> Motion:
        shares = (1.0, 0.85, 0.7, 0.5)
        return self._motion("lift", Shift((0.0, 0.0, z), speed=speed, shares=shares))

    def retreat(self, distance: float) -> Motion:
        shares = (1.0, 0.75, 0.5)
        return self._motion("retreat", Shift((-distance, 0.0, 0.0), tool=True, shares=shares))

    def advance(self, distance: float, until: str = "", speed: float = 1.0) -> Motion:
        step = Shift((distance, 0.0, 0.0), tool=True, until=until, speed=speed)
        return self._motion("advance", step)

    def press(self, prop: str, reach: float, push: float = 0.004) -> Motion:
        steps = (
            Shift((reach, 0.0, 0.0), tool=True, until=prop, must=True, speed=0.5),
            # Recorded actions are 60 ms apart: without leaning in and staying, the deepest
            # moment would fall between two of them.
            Shift((push, 0.0, 0.0), tool=True),
            Wait(0.12),
        )
        return self._motion(f"press {prop}", *steps)

    def reach(self, *candidates: Pose) -> Motion:
        return self._motion("reach", Reach(candidates))

    def line(self, goal: Pose, speed: float = 1.0, until: str = "") -> Motion:
        return self._motion("line", Line(goal, speed=speed, until=until))

    def sweep(
        self, *paths: Sequence[Pose], seconds: float = 0.0, prop: str = "", speed: float = 1.0
    ) -> Motion:
        self.robot.refresh()
        for path in paths:
            q = self.robot.path_posture(self.side, path)
            if q is not None and self.robot.clear_at(self.side, q, prop):
                reach = Reach((path[0],), tuple(q.tolist()), speed=speed)
                steps = (reach, Follow(tuple(path[1:]), seconds))
                return self._motion(f"sweep {prop}".strip(), *steps)
        raise Infeasible("unreachable", f"no way for the {self.side} hand along {prop or 'a path'}")

    def carry(
        self, prop: str, *paths: Sequence[Pose], seconds: float = 0.0, speed: float = 1.0
    ) -> Motion:
        X_PE = self.robot.scene.pose(prop).inverse() @ self.ee()
        hands = [[pose @ X_PE for pose in path] for path in paths]
        return self.sweep(*hands, seconds=seconds, prop=prop, speed=speed)

    def close(self, opening: float = 0.0, holds: str = "") -> Motion:
        return self._motion("close", Grip(opening, holds=holds))

    def open(self, opening: float = 1.0) -> Motion:
        held = self.robot.holding.get(self.side, "")
        return self._motion("open", Grip(opening, releases=held))

    def home(self) -> Motion:
        return self._motion("home", Home())

    def wait(self, seconds: float) -> Motion:
        return self._motion("wait", Wait(seconds))

    def _motion(self, stage: str, *steps: Step) -> Motion:
        return Motion(self.side, f"{self.side} {stage}", steps)
