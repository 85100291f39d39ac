"""The robot that scripts command (`rtphys.task.arm.Robot`): plans steps and carries them out."""

from collections.abc import Callable, Iterable, Iterator, Sequence
from contextlib import contextmanager, nullcontext
from functools import partial

import numpy as np

from rtphys.assets.action_layout import SIDES
from rtphys.assets.embodiment import Hand
from rtphys.core.errors import Infeasible
from rtphys.core.poses import Array, Pose
from rtphys.expert.arm import ExpertArm
from rtphys.expert.hands import Hands
from rtphys.expert.planner import ArmGoal, DualArmPlanner
from rtphys.expert.recovery import PLANNING, retake
from rtphys.expert.surroundings import obstacles_of
from rtphys.plan.path import Trajectory
from rtphys.sim.recorder import RECOVER
from rtphys.sim.rollout import Rollout
from rtphys.task.arm import Arm, Follow, Grip, Home, Line, Motion, Reach, Shift, Step, T, Wait

SETTLED = 0.003  # [rad] largest tracking error before the fingers act
SETTLE_STEPS = 60


class ExpertRobot:
    """Both arms of one rollout, driven through the same targets that a policy sets."""

    def __init__(
        self, rollout: Rollout, rng: np.random.Generator, may_recover: bool = True
    ) -> None:
        """
        Args:
            may_recover: false ends the attempt ("recovered") where a second try is due.
        """
        self.rollout, self.scene, self.world = rollout, rollout.scene, rollout.world
        self.planner = DualArmPlanner(self.world.robot.embodiment, rng)
        self.hands = Hands(rollout, self.planner)
        self.may_recover, self.recovering = may_recover, False
        self._moving: set[str] = set()  # arms of the step being carried out
        self._intended: dict[str, Array] = {}  # where verbs said since the last `do` will end
        self._at: dict[str, str] = {}  # and around which prop
        self._told: tuple[int, set[str]] | None = None  # when the planner last saw everything
        self.left, self.right = ExpertArm(self, "left"), ExpertArm(self, "right")
        self.refresh()

    # ---- what scripts say ------------------------------------------------------------------------

    @property
    def hand(self) -> Hand:
        """Measures of each arm's gripper [m]."""
        return self.world.robot.embodiment.hand

    @property
    def holding(self) -> dict[str, str]:
        """Side -> prop in that hand."""
        return self.hands.holding

    def arm(self, side: str) -> ExpertArm:
        return self.left if side == "left" else self.right

    def nearest(self, prop: str) -> ExpertArm:
        return self.arm("left" if self.scene.pose(prop).p[0] < 0 else "right")

    def other(self, arm: Arm) -> ExpertArm:
        return self.right if arm.side == "left" else self.left

    def do(self, *motions: Motion) -> None:
        queues: dict[str, list[Step]] = {side: [] for side in SIDES}
        for motion in motions:
            queues[motion.side].extend(motion.steps)
        self._intended.clear()
        self._at.clear()
        stage = " + ".join(dict.fromkeys(m.stage for m in motions))
        self.rollout.recorder.enter(f"{RECOVER} {stage}" if self.recovering else stage)
        for i in range(max((len(q) for q in queues.values()), default=0)):
            self._together({side: q[i] for side, q in queues.items() if i < len(q)})

    def tried(self, action: Callable[[], object]) -> bool:
        before = self.rollout.steps
        try:
            action()
        except Infeasible as problem:
            if problem.reason not in PLANNING or self.rollout.steps != before:
                raise
            return False
        return True

    def first_feasible(self, options: Iterable[T], act: Callable[[T], object]) -> T | None:
        for option in options:
            if self.tried(partial(act, option)):
                return option
        return None

    def retake(self, action: Callable[[], None]) -> None:
        retake(self, action)

    # ---- questions of the verbs ------------------------------------------------------------------

    def commanded(self, side: str) -> Array:
        """Commanded posture (n,) [rad]."""
        return self.world.robot.arm(side).target

    def commanded_ee(self, side: str) -> Pose:
        """Commanded ee pose, task frame."""
        ee = self.planner.kinematics[side].ee_pose(self.commanded(side))
        return self.world.to_task(ee)

    def grasp_posture(self, side: str, prop: str, before: Pose, at: Pose) -> Array | None:
        """Posture for the first pose, if both are reachable on one branch and clear.

        At the second, the hand may touch the prop.
        """
        q = self._posture(side, before)
        if q is None or not self._clear_with(side, q):
            return None
        line = self.planner.lines(side, q, [self.world.X_WT @ at])
        if line is None:
            return None
        with self.hands.may_touch(side, prop):
            if not self._clear_with(side, line[-1]):
                return None
        self._intended[side], self._at[side] = line[-1], prop
        return q

    def path_posture(self, side: str, poses: Sequence[Pose]) -> Array | None:
        """Posture for the first pose, if the others follow from it by straight lines."""
        q = self._posture(side, poses[0])
        if q is None:
            return None
        path = self.planner.lines(side, q, [self.world.X_WT @ pose for pose in poses[1:]])
        if path is not None:
            self._intended[side] = path[-1]
        return None if path is None else q

    def way_is_clear(self, side: str, q: Array) -> bool:
        """Nothing touches at the start `q` of the last path asked about, nor where it ends."""
        return all(self._clear_with(side, at) for at in (q, self._intended[side]))

    @contextmanager
    def supposing(self, side: str) -> Iterator[None]:
        """Within: questions about this arm do not count as where it will go."""
        said = self._intended.get(side)
        try:
            yield
        finally:
            self._intended.pop(side, None)
            if said is not None:
                self._intended[side] = said

    def clear_at(self, side: str, q: Array, prop: str) -> bool:
        """Nothing in the way at a posture, the prop aside."""
        with self.hands.may_touch(side, prop):
            return self._clear_with(side, q)

    def _posture(self, side: str, ee: Pose) -> Array | None:
        return self.planner.posture(side, self.world.X_WT @ ee, self.commanded(side))

    def _clear_with(self, side: str, q: Array) -> bool:
        postures = {s: self.commanded(s) for s in SIDES}
        other = "right" if side == "left" else "left"
        if other in self._intended:
            postures[other] = self._intended[other]
        elif not self.hands.holding.get(other):
            # Whether the other arm is in the way now does not matter: it can move first.
            postures[other] = self.world.robot.arm(other).limb.home
        postures[side] = q
        around = self._at.get(other, "")
        with self.hands.may_touch(other, around) if around else nullcontext():
            return self.planner.clear(postures)

    # ---- carrying out ----------------------------------------------------------------------------

    def refresh(self) -> None:
        """Tell the planner where everything is now."""
        held = set(self.hands.holding.values())
        now = self.rollout.steps, held
        if now != self._told:  # nothing moves between two steps
            self.planner.set_obstacles(obstacles_of(self.world, without=held))
            self._told = now

    def _together(self, steps: dict[str, Step]) -> None:
        """One step of one or both arms, at the same time."""
        self.refresh()
        goals = {s: g for s, step in steps.items() if (g := self._goal(s, step)) is not None}
        grips = {s: step for s, step in steps.items() if isinstance(step, Grip)}
        waits = [step.seconds for step in steps.values() if isinstance(step, Wait)]
        until = {s: w for s, step in steps.items() if (w := getattr(step, "until", ""))}
        if grips:
            self._settle()
        ramps = {side: self.hands.ramp(side, grip.opening) for side, grip in grips.items()}
        room = max((getattr(step, "room", 0.0) for step in steps.values()), default=0.0)
        trajectory = self._plan(goals, room) if goals else None
        self._moving = set(goals)
        touched = self._run(trajectory, ramps, until, max(waits, default=0.0))
        for side, step in steps.items():
            if isinstance(step, Shift) and step.must and side not in touched:
                raise Infeasible("stalled", f"the {side} hand did not meet {step.until}")
        for side, grip in grips.items():
            self.hands.closed(side, grip)
        if not grips:
            self.hands.still_held()

    def _plan(self, goals: dict[str, ArmGoal], room: float) -> Trajectory:
        start = {side: self.commanded(side) for side in SIDES}
        if not room:
            return self.planner.motion(start, goals, self.hands.pace())
        self.planner.checker.keep_carried_clear(room)
        try:
            return self.planner.motion(start, goals, self.hands.pace())
        finally:
            self.planner.checker.keep_carried_clear()

    def _goal(self, side: str, step: Step) -> ArmGoal | None:
        if isinstance(step, Home):
            return ArmGoal(q=self.world.robot.arm(side).limb.home)
        if isinstance(step, Line):
            return ArmGoal(line=(self.world.X_WT @ step.goal,), speed=step.speed)
        if isinstance(step, Follow):
            poses = tuple(self.world.X_WT @ pose for pose in step.poses)
            return ArmGoal(line=poses, seconds=step.seconds)
        if isinstance(step, Shift):
            return self._shift_goal(side, step)
        if isinstance(step, Reach):
            if step.posture:
                return ArmGoal(q=np.array(step.posture), speed=step.speed)
            for pose in step.candidates:
                q = self._posture(side, pose)
                if q is not None and (len(step.candidates) == 1 or self._clear_with(side, q)):
                    return ArmGoal(q=q, speed=step.speed)
            raise Infeasible("unreachable", f"no posture of the {side} arm")
        return None

    def _shift_goal(self, side: str, step: Shift) -> ArmGoal:
        ee = self.commanded_ee(side)
        offset = ee.R @ np.asarray(step.offset) if step.tool else np.asarray(step.offset)
        for share in step.shares:
            goal = Pose(ee.p + share * offset, step.turn or ee.q)
            world = self.world.X_WT @ goal
            if self.planner.kinematics[side].line(self.commanded(side), world) is not None:
                return ArmGoal(line=(world,), speed=step.speed)
            if step.turn:  # a large turn may need another branch: go there freely
                q = self._posture(side, goal)
                if q is not None:
                    return ArmGoal(q=q, speed=step.speed)
        raise Infeasible("unreachable", f"the {side} hand cannot move by {step.offset}")

    def _run(
        self, trajectory, ramps: dict[str, Array], until: dict[str, str], wait: float
    ) -> set[str]:
        arms = {side: self.world.robot.arm(side) for side in SIDES}
        openings = {side: ramp.tolist() for side, ramp in ramps.items()}
        paths = {side: self._path_of(trajectory, side) for side in SIDES if side in self._moving}
        length = max(
            [len(trajectory) if trajectory is not None else 0]
            + [len(r) for r in ramps.values()]
            + [round(wait * 250)]
        )
        stopped: set[str] = set()
        # The motion may end early once every arm that moves has met what it should stop at.
        moving = self._moving
        for k in range(length):
            for side, (q, qd) in paths.items():
                if side not in stopped:
                    row = min(k, len(q) - 1)
                    arms[side].drive(q[row], qd[row])
            for side, ramp in openings.items():
                arms[side].grip(ramp[min(k, len(ramp) - 1)])
            self.rollout.tick()
            for side, prop in until.items():
                if side not in stopped and self.hands.presses(side, prop):
                    stopped.add(side)
                    arms[side].stop()
            if until and not ramps and stopped == moving:
                break
        for arm in arms.values():
            arm.stop()
        return stopped

    def _path_of(
        self, trajectory: Trajectory, side: str
    ) -> tuple[list[list[float]], list[list[float]]]:
        """Positions and velocities of one arm, a row a step, as plain floats."""
        columns = self.planner.columns[side]
        return trajectory.q[:, columns].tolist(), trajectory.qd[:, columns].tolist()

    def _settle(self) -> None:
        """Wait until both arms are where they were told to be."""
        for _ in range(SETTLE_STEPS):
            errors = [np.abs(a.measured() - a.target).max() for a in self.world.robot.arms]
            if max(errors) < SETTLED:
                return
            self.rollout.tick()
