"""The policy interface: what an action does (RoboTwin's `take_action`), and open-loop replays."""

from collections.abc import Sequence
from typing import Literal, get_args

import numpy as np

from rtphys.assets.action_layout import ActionLayout
from rtphys.assets.embodiment import Embodiment
from rtphys.assets.pack import Pack
from rtphys.core.errors import BadValue, Infeasible, UnknownName
from rtphys.core.poses import Array, Pose
from rtphys.core.seeds import stream
from rtphys.episode.generate import prepare, settle, start
from rtphys.plan.kinematics import arm_kinematics
from rtphys.plan.trajectory import JointLimits, Straight, Tracker, Trajectory
from rtphys.sim.recorder import FRAME_STEPS, Recording
from rtphys.sim.rollout import Rollout, RolloutOptions
from rtphys.spec.episode import Recipe
from rtphys.task.spec import Task

ActionKind = Literal["qpos", "ee", "delta_ee", "tracked_qpos"]
KINDS: tuple[ActionKind, ...] = get_args(ActionKind)
POSES = ActionLayout(7, 7)
# What an action of ee poses holds.
POSE_KINDS = {
    "ee": "left ee xyz [m] + wxyz, left gripper 0..1, right ee, right gripper",
    "delta_ee": "left ee shift xyz [m] + turn wxyz, left gripper 0..1, right ee and gripper",
}
# Of one action: no harsher than the expert, whose loads would be shaken loose.
VELOCITY, ACCELERATION = 3.0, 10.0  # [rad/s], [rad/s^2] of every joint
# Of actions that are noted: beyond rounding; in this share of the actions; further than any joint
# turns [rad]; further than an action at 17 Hz goes [rad]; nearly the same numbers.
ROUNDING, OFTEN, TURN, JUMP, SAME = 1e-3, 0.2, 6.3, 0.5, 0.1
LOST_STEPS = 50  # what an action takes when no arm can do it (RoboTwin idles as long)


def shape_of(kind: str, embodiment: Embodiment) -> tuple[int, str]:
    """How many numbers an action of this kind has, and what they are. Raises `UnknownName`."""
    if kind not in KINDS:
        raise UnknownName("kind of action", kind, KINDS)
    if kind in POSE_KINDS:
        return POSES.size, POSE_KINDS[kind]
    return embodiment.action_layout.size, str(embodiment.action_layout)


class ActionLog:
    """Where a policy's actions did not fit the robot: counts, and what is usually the cause.

    Args:
        low, high: (N,) limits of joints [rad] and openings.
        present: (N,) commanded before the first action.
    """

    def __init__(self, layout: ActionLayout, low: Array, high: Array, present: Array) -> None:
        self.layout, self.low, self.high, self.present = layout, low, high, present
        self.actions = 0
        self.first: Array | None = None  # the first action of joint targets
        self._beyond = np.zeros(len(low), int)
        self._least, self._most = present.copy(), present.copy()

    def add(self, numbers: Array, at: Sequence[int] | None = None) -> None:
        """Count an action's numbers; `at`: which of the robot's they are, if not all."""
        places = list(range(len(self.low))) if at is None else list(at)
        self.actions += 1
        if at is None and self.first is None:
            self.first = numbers.copy()
        outside = (numbers < self.low[places] - ROUNDING) | (numbers > self.high[places] + ROUNDING)
        self._beyond[places] += outside
        self._least[places] = np.minimum(self._least[places], numbers)
        self._most[places] = np.maximum(self._most[places], numbers)

    @property
    def clipped(self) -> dict[str, int]:
        """In how many actions a number was clipped to its limits, by the number's name."""
        return {n: int(k) for n, k in zip(self.layout.names, self._beyond, strict=True) if k}

    def usual_cause(self) -> str:
        """What such actions usually mean, in one line; empty where nothing is unusual."""
        hands = list(self.layout.grippers)
        arms = [i for i in range(len(self.low)) if i not in hands]
        beyond, first = self._beyond / max(self.actions, 1), self.first
        jump = np.zeros(len(self.low)) if first is None else np.abs(first - self.present)
        ordered = first is None or not _alike(np.sort(first), np.sort(self.present))
        if jump.max() > JUMP and not ordered:
            return "the first action has the numbers of the present posture in another order"
        if beyond[arms].max() >= OFTEN:
            far = float(max(self._most[arms].max(), -self._least[arms].min()))
            where = f"joints are beyond their limits in {beyond[arms].max():.0%} of the actions"
            kind = "degrees" if far > TURN else "normalised, differences, or in another order"
            return f"{where}, up to {far:.3g} rad: {kind}?"
        if beyond[hands].max() >= OFTEN:
            span = f"{self._least[hands].min():.3g} to {self._most[hands].max():.3g}"
            return f"openings are {span}; they are 0 (closed) to 1 (open), not -1 to 1 or metres"
        if jump[arms].max() > JUMP:
            where = f"the first action is {jump[arms].max():.2g} rad from the present posture"
            return f"{where}: normalised, differences, or in another order?"
        if first is not None and _alike(first[hands], 1 - self.present[hands]):
            return "the first action turns both openings over: inverted, or differences?"
        return ""


def _alike(numbers: Array, others: Array) -> bool:
    return bool(np.abs(numbers - others).max() < SAME)


class PolicyControl:
    """Carries out actions at 250 Hz, each from rest to rest but those that are tracked.

    Inverse kinematics draws its restarts from a stream of the episode's `seed`.
    """

    def __init__(self, rollout: Rollout, seed: int = 0) -> None:
        self.rollout = rollout
        self.actions = self.unreachable = 0  # unreachable: arms sent where they cannot go
        self._rng = stream(seed, "policy", "kinematics")
        robot = rollout.world.robot
        self._arms, self._embodiment = robot.arms, robot.embodiment
        bounds = [np.vstack([arm.limb.limits, [0.0, 1.0]]) for arm in robot.arms]
        present = np.array([number for arm in robot.arms for number in arm.commanded])
        low, high = np.concatenate(bounds).T
        layout = robot.embodiment.action_layout
        self.log = ActionLog(layout, low, high, present)  # of what was asked, before it is clipped
        self._limits = [
            JointLimits(np.full(n, VELOCITY), np.full(n, ACCELERATION)) for n in layout.per_arm
        ]
        self._trackers: list[Tracker] = []  # while actions are tracked

    def act(self, action: Array, kind: ActionKind = "qpos") -> bool:
        """One action; True as soon as the success condition holds.

        The arms go straight in joint space from the present targets to the action's; the gripper
        command is interpolated over the same time. An action lasts at least one frame.

        Args:
            action: "qpos": (14,) absolute joint targets and openings, in the order of the robot's
                `ActionLayout`; 14 with six joints an arm. "ee": (16,) absolute world
                poses of the ee frames and openings; an arm that cannot get there keeps
                still. "delta_ee": as "ee", the shift in world axes and the turn about the ee's
                origin in world axes, both from the pose that is commanded now. "tracked_qpos":
                as "qpos", but the arms head for the targets for one frame only, and the next
                such action bends their motion. One of another kind begins with a dead stop.

        Raises:
            BadValue: wrong shape, not finite, or a quaternion without length.
            UnknownName: no such kind.
            Infeasible: "too_slow", past the rollout's own limit of steps.
        """
        size, what = shape_of(kind, self._embodiment)
        action = np.asarray(action, float)
        if action.shape != (size,) or not np.isfinite(action).all():
            raise BadValue("action", action.tolist(), f"it is {size} finite numbers: {what}")
        layout, lost = self._embodiment.action_layout, 0
        if kind in POSE_KINDS:
            hands, layout = layout.grippers, POSES
            quaternions = [action[part][3:] for part in POSES.arms]
            if np.linalg.norm(quaternions, axis=1).min() < 0.1:
                raise BadValue("action", action.tolist(), "its quaternions have length 1")
            postures = [self._posture(i, action[part], kind) for i, part in enumerate(POSES.arms)]
            lost = sum(q is None for q in postures)
            pairs = zip(self._arms, postures, strict=True)
            goals = [arm.target if q is None else q for arm, q in pairs]
            self.log.add(action[list(POSES.grippers)], hands)
        else:
            goals = [action[part] for part in layout.arms]
            self.log.add(action)
        self.actions += 1
        self.unreachable += lost
        paths = self._paths(goals, kind == "tracked_qpos")
        least = LOST_STEPS if lost == len(self._arms) else FRAME_STEPS
        return self._run(paths, np.clip(action[list(layout.grippers)], 0.0, 1.0), least)

    def commanded_ee(self) -> tuple[Pose, Pose]:
        """World poses of the ee frames at the commanded postures, left and right."""
        kinematics = arm_kinematics(self._embodiment)
        left, right = (kinematics[arm.side].ee_pose(arm.target) for arm in self._arms)
        return left, right

    def _posture(self, index: int, numbers: Array, kind: ActionKind) -> Array | None:
        goal = Pose(numbers[:3], numbers[3:])
        if kind == "delta_ee":
            now = self.commanded_ee()[index]
            goal = Pose(now.p + goal.p, (Pose(q=goal.q) @ Pose(q=now.q)).q)
        arm = self._arms[index]
        return arm_kinematics(self._embodiment)[arm.side].solve_near(goal, arm.target, self._rng)

    def _paths(self, goals: list[Array], tracked: bool) -> list[Trajectory]:
        """Motions of both arms: straight ones from rest, of equal length, a frame at least; or, of
        tracked actions, the next frame towards these targets from whatever speed the arms have.

        A small motion fills its frame: at full acceleration and with a rest after it, every frame
        of a slow transfer would shake the load.
        """
        within = zip(self._arms, goals, self._limits, strict=True)
        ways = [(arm.target, np.clip(g, *arm.limb.limits.T), limits) for arm, g, limits in within]
        if not tracked:
            self._trackers, motions = [], [Straight(*way) for way in ways]
            steps = max(FRAME_STEPS, *(motion.steps for motion in motions))
            return [motion.sampled(steps) for motion in motions]
        self._trackers = self._trackers or [Tracker(start, limits) for start, _, limits in ways]
        for tracker, (_, goal, _) in zip(self._trackers, ways, strict=True):
            tracker.follow(goal)
        return [tracker.advance(FRAME_STEPS) for tracker in self._trackers]

    def _run(self, paths: list[Trajectory], grips: Array, least: int) -> bool:
        # A motion's first sample is where the arm already is.
        length = max(least, *(len(path) - 1 for path in paths))
        motions = [
            (arm, path.q.tolist(), path.qd.tolist(), len(path) - 1, arm.gripper, g1 - arm.gripper)
            for arm, path, g1 in zip(self._arms, paths, grips.tolist(), strict=True)
        ]
        tick = self.rollout.tick
        for k in range(1, length + 1):
            share = k / length
            for arm, q, qd, last, g0, change in motions:
                row = k if k < last else last
                arm.drive(q[row], qd[row])
                arm.grip(g0 + share * change)
            if tick():
                return True
        return False


def actions_of(recording: Recording) -> Array:
    """Absolute targets (T - 1, N) in the recording's layout: what is in force one frame later."""
    return np.array([row.arms for row in recording.rows[1:]])


def replay(recipe: Recipe, task: Task, pack: Pack, actions: Array) -> bool:
    """Whether the actions alone succeed in a fresh world of the same recipe.

    Policy time runs slower than the demonstration's: each action is a motion of its own.
    """
    try:
        instance = prepare(recipe, task, pack)
        settle(instance)
        control = PolicyControl(start(instance, RolloutOptions(keep="nothing")))
        return any(control.act(action) for action in actions[: task.step_limit])
    except Infeasible:
        return False
