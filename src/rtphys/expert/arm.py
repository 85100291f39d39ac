"""The verbs of one arm (`rtphys.task.arm.Arm`): each becomes steps with feasible poses."""

from collections.abc import Iterator, Sequence
from dataclasses import replace
from itertools import chain, islice
from typing import NamedTuple

import numpy as np

from rtphys.core.errors import Infeasible
from rtphys.core.poses import Array, Pose, axis_angle
from rtphys.expert.feasibility import Feasibility, Intent, Path
from rtphys.expert.grasp import STRAIGHT_DOWN, Grasp, HeldLoad, candidates, goals
from rtphys.task.arm import Aim, Arm, Follow, Grip, Line, Motion, Placing, Reach, Step, leaning
from rtphys.task.props import TABLE_TOP

ROOM = 0.01  # [m] round a load that is brought into something: servos lag, and loads sag
# [m] Room from a contact point to the palm: hands with less take things nearer to their fingertips.
PALMS = (0.03, 0.042)
TURNED = 0.35  # [rad] of a load in its hand that keeps it from being placed as it was meant to be
HANGING = 0.05  # [m] by which it may then hang lower
MAX_AIMED = 30  # grasps that are tested for what they allow later
_PLACE_YAWS = (0.0, 0.4, -0.4, 0.8, -0.8, 1.57, -1.57)  # [rad] tried where the yaw is free


class Placement(NamedTuple):
    """Hand poses before and at a placement, and the postures there."""

    before: Pose
    at: Pose
    path: Path


class ExpertArm(Arm):
    """Verbs of one arm. What depends on the moment is read when the verb is called.

    Args:
        feasibility: what verbs ask.
        intents: by side, what verbs have decided since the robot last moved. A verb asks with the
            other arm's and writes its own as soon as a path is found; one that then fails leaves
            the last that it wrote.
    """

    def __init__(self, side: str, feasibility: Feasibility, intents: dict[str, Intent]) -> None:
        self.side, self._feasibility, self._intents = side, feasibility, intents
        self._world, self._scene = feasibility.world, feasibility.scene
        self._hands = feasibility.hands
        self.hand = self._world.robot.arm(side).limb.hand

    def ee(self) -> Pose:
        return self._feasibility.commanded_ee(self.side)

    @property
    def _other(self) -> Intent | None:
        """What the other arm is about to do."""
        return self._intents.get("right" if self.side == "left" else "left")

    def _intend(self, path: Path, around: str = "") -> None:
        """State where this arm will go, and the prop it may touch there (empty: as before)."""
        before = self._intents.get(self.side)
        around = around or (before.around if before else "")
        self._intents[self.side] = Intent(path.end, around)

    def _clear(self, q: Array, prop: str = "") -> bool:
        """Nothing touches at a posture, but that the hand may touch the prop."""
        return self._feasibility.clear(self.side, q, self._other, prop)

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
        self._feasibility.refresh()
        taken = self._world.object(prop)
        numbers = list(contacts) or list(range(len(taken.contact_points)))
        if not numbers:
            raise Infeasible("ungraspable", f"{prop} has no contact points")
        points = [(i, self._scene.contact(prop, i)) for i in numbers]
        axis = taken.prop.rolling_axis
        if axis is not None:  # a round thing lies as it rolled: 22.5 deg beside each point as well
            X_TP = self._scene.pose(prop)
            beside = X_TP @ Pose((0, 0, 0), axis_angle(axis, np.pi / 8)) @ X_TP.inverse()
            points += [(i, beside @ point) for i, point in points]
        # A dict, for most hands have room enough: then there is one number, 0.
        short = dict.fromkeys(max(0.0, palm - self.hand.palm) for palm in PALMS)
        found = chain(*(self._reachable_grasps(prop, points, pre, depth, each) for each in short))
        reachable = islice(found, MAX_AIMED)
        first = next(reachable, None)
        if first is None:
            raise Infeasible("unreachable", f"no contact point of {prop} for the {self.side} hand")
        fit = (
            each
            for each in chain([first], reachable)
            if aim is None or self._allows(prop, each[1], aim)
        )
        choice, at, path = next(fit, first)
        self._intend(path, prop)
        steps = (
            Reach((choice.backed_off(pre),), tuple(path.start.tolist())),
            Line(at),
            Grip(grip, holds=prop),
        )
        return self.motion(f"grasp {prop}", *steps)

    def _reachable_grasps(
        self, prop: str, points: list[tuple[int, Pose]], pre: float, depth: float, short: float
    ) -> Iterator[tuple[Grasp, Pose, Path]]:
        """Grasps that nothing hinders, best first, with their ee poses; sought when asked for.

        Args:
            short: room that the palm lacks where the TCP is at the contact point [m].
        """
        for grasp in candidates(points, self.side, TABLE_TOP, self.hand):
            # Counted once: things too thin for the fingertips, and scripts, back the hand off too.
            back = depth + max(0.0, short - grasp.raised - max(0.0, depth))
            poses = grasp.backed_off(pre), grasp.backed_off(back)
            path = self._feasibility.grasp(self.side, prop, poses, self._other)
            if path is not None:
                yield grasp, poses[1], path

    def _allows(self, prop: str, hand: Pose, aim: Aim) -> bool:
        """Whether a prop grasped at this hand pose can be placed as aimed."""
        load = self._load(prop, hand, aim.point)
        return any(self._placements(load, aim.target, aim.how, intend=False))

    def hover(
        self, prop: str, contact: int = 0, gap: float = 0.1, straight_down: bool = False
    ) -> Motion:
        point = self._scene.contact(prop, contact)
        if straight_down:
            back = Pose(point.p + np.array([0, 0, self.hand.tcp + gap]), STRAIGHT_DOWN)
            return self.motion(f"hover {prop}", Reach((back,)))
        # Unlike a grasp, a hover must not be shifted away from thin objects: nothing is held.
        grasps = candidates([(contact, point)], self.side, -np.inf, self.hand)
        poses = tuple(grasp.backed_off(gap) for grasp in grasps)
        return self.motion(f"hover {prop}", Reach(poses))

    # ---- letting go ------------------------------------------------------------------------------

    def place(
        self, prop: str, target: Pose, point: int | None = None, how: Placing | None = None
    ) -> Motion:
        how = how or Placing()
        self._feasibility.refresh()
        # The commanded hand, not the measured one: the load's droop is then in the grasp, and the
        # load itself arrives where it should.
        load = self._load(prop, self.ee(), point)
        placement = next(self._placements(load, target, how), None)
        if self._hands.turned(self.side) > TURNED and not self._starts_clear(placement, prop):
            # It hangs too far askew: as it was grasped, then, which what it is set on restores.
            higher = replace(how, pre=how.pre + float(np.copysign(HANGING, how.pre)))
            grasped = self._as_grasped(prop, point)
            placement = next(self._placements(grasped, target, higher), None)
            if not self._starts_clear(placement, prop):
                turned = f"{prop} has turned in the {self.side} hand, past placing"
                raise Infeasible("slipped", turned)
        if placement is None:
            raise Infeasible("unreachable", f"the {self.side} hand cannot place {prop} there")
        before, at, path = placement
        posture = tuple(path.start.tolist())
        steps: list[Step] = [Reach((before,), posture, ROOM if how.clear else 0.0, how.speed)]
        if how.pre != how.gap:
            steps.append(Line(at, until=how.until))
        if how.until:
            last = at.p - before.p
            lean = how.lean * last / max(float(np.linalg.norm(last)), 1e-9)
            steps += leaning((float(lean[0]), float(lean[1]), float(lean[2])))
        if how.release:
            steps.append(Grip(1.0, releases=prop))
        return self.motion(f"place {prop}", *steps)

    def _starts_clear(self, placement: Placement | None, prop: str) -> bool:
        return placement is not None and self._clear(placement.path.start, prop)

    def _load(self, prop: str, hand: Pose, point: int | None) -> HeldLoad:
        functional = None if point is None else self._scene.functional(prop, point)
        return HeldLoad(self.side, hand, self._scene.pose(prop), functional)

    def _as_grasped(self, prop: str, point: int | None) -> HeldLoad:
        """The load as it was when the hand closed."""
        hand, scene = self.ee(), self._scene
        X_TP = hand @ self._hands.grasped[self.side]
        X_PT = scene.pose(prop).inverse()
        functional = None if point is None else X_TP @ X_PT @ scene.functional(prop, point)
        return HeldLoad(self.side, hand, X_TP, functional)

    def _placements(
        self, load: HeldLoad, target: Pose, how: Placing, intend: bool = True
    ) -> Iterator[Placement]:
        """Placements that are reachable, and clear where they must be, each sought when asked for.

        Args:
            intend: state each reachable one as this arm's intent.
        """
        yaws = how.yaws
        if yaws == (0.0,) and how.mode in ("free", "auto"):
            yaws = _PLACE_YAWS
        for yaw in yaws:
            before, at = goals(load, target, how, yaw)
            path = self._feasibility.path(self.side, (before, at), self._other, how.release)
            if path is None:
                continue
            if intend:
                self._intend(path)
            if not how.clear or (self._clear(path.start) and self._clear(path.end)):
                yield Placement(before, at, path)

    # ---- along a path ----------------------------------------------------------------------------

    def sweep(
        self, *paths: Sequence[Pose], seconds: float = 0.0, prop: str = "", speed: float = 1.0
    ) -> Motion:
        self._feasibility.refresh()
        for poses in paths:
            path = self._feasibility.path(self.side, poses, self._other)
            if path is None:
                continue
            self._intend(path)
            if self._clear(path.start, prop):
                reach = Reach((poses[0],), tuple(path.start.tolist()), speed=speed)
                steps = (reach, Follow(tuple(poses[1:]), seconds))
                return self.motion(f"sweep {prop}".strip(), *steps)
        raise Infeasible("unreachable", f"no way for the {self.side} hand along {prop or 'a path'}")

    def carry(
        self, prop: str, *paths: Sequence[Pose], seconds: float = 0.0, speed: float = 1.0
    ) -> Motion:
        X_PE = self._scene.pose(prop).inverse() @ self.ee()
        hands = [[pose @ X_PE for pose in path] for path in paths]
        return self.sweep(*hands, seconds=seconds, prop=prop, speed=speed)

    def felt(self) -> Array:
        rows = self._feasibility.rollout.recorder.recording.rows[self._feasibility.felt_from :]
        arm, world = self._world.robot.arm(self.side), self._world
        kinematics, tcp = self._feasibility.planner.kinematics[self.side], (self.hand.tcp, 0.0, 0.0)
        wrenches = [
            kinematics.wrench(row.qpos[arm.index], row.effort[arm.index], np.array(tcp))
            for row in rows
        ]
        R_TW = world.X_WT.R.T
        return np.array([np.concatenate([R_TW @ w[:3], R_TW @ w[3:]]) for w in wrenches])

    def open(self, opening: float = 1.0) -> Motion:
        load = self._hands.holding.get(self.side, "")
        return self.motion("open", Grip(opening, releases=load))
