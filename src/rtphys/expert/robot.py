"""The robot that scripts command (`rtphys.task.arm.Robot`): plans steps and carries them out."""

from collections.abc import Callable

import numpy as np

from rtphys.assets.action_layout import SIDES
from rtphys.core.errors import Infeasible
from rtphys.core.poses import Array, Pose
from rtphys.expert.arm import ExpertArm
from rtphys.expert.feasibility import Feasibility, Intent
from rtphys.expert.hands import Hands
from rtphys.expert.planner import ArmGoal, DualArmPlanner
from rtphys.physics.values import Physics
from rtphys.plan.collision import RESTING_MARGIN
from rtphys.plan.trajectory import Trajectory
from rtphys.sim.recorder import RECOVER
from rtphys.sim.rollout import Rollout
from rtphys.task.arm import Follow, Grip, Home, Line, Motion, Reach, Robot, Shift, Step, Wait

LOST = frozenset({"slipped", "grasp_missed"})  # reasons that a second try may cure
PLANNING = frozenset({"unreachable", "no_path", "retime_failed", "ungraspable"})
BACK_OFF = 0.08  # [m] the way a hand came in to grasp
CALM = 0.4  # [s] for what was dropped to come to rest
CARE = 0.6  # share of the first pace with which a load is carried that slipped once
SETTLED = 0.003  # [rad] largest tracking error before the fingers act
SETTLE_STEPS = 60


class ExpertRobot(Robot):
    """Both arms of one rollout, driven through the same targets that a policy sets."""

    def __init__(
        self,
        rollout: Rollout,
        rng: np.random.Generator,
        may_recover: bool = True,
        belief: Physics | None = None,
    ) -> None:
        """
        Args:
            may_recover: false ends the attempt ("recovered") where a second try is due.
            belief: what it takes the physics to be; None: it knows it.
        """
        self.rollout, self.world = rollout, rollout.world
        self.planner = DualArmPlanner(self.world.robot.embodiment, rng)
        self.hands = Hands(rollout, self.planner)
        self.believe(belief or rollout.scene.physics)
        self._feasibility = Feasibility(rollout, self.planner, self.hands)
        self._may_recover, self._recovering = may_recover, False
        self._intents: dict[str, Intent] = {}  # by side, of verbs called since the last `do`
        self.left, self.right = (
            ExpertArm(side, self._feasibility, self._intents) for side in SIDES
        )
        self._feasibility.refresh()

    def believe(self, physics: Physics) -> None:
        """Take the physics to be this from now on."""
        self.scene = self.rollout.scene.believing(physics)
        self.hands.belief = physics

    # ---- what scripts say ------------------------------------------------------------------------

    def do(self, *motions: Motion) -> None:
        queues: dict[str, list[Step]] = {side: [] for side in SIDES}
        for motion in motions:
            queues[motion.side].extend(motion.steps)
        self._intents.clear()
        self._feasibility.felt_from = len(self.rollout.recorder.recording.rows)
        stage = " + ".join(dict.fromkeys(m.stage for m in motions))
        self.rollout.recorder.enter(f"{RECOVER} {stage}" if self._recovering else stage)
        for i in range(max((len(q) for q in queues.values()), default=0)):
            self._together({side: q[i] for side, q in queues.items() if i < len(q)})

    def seen(self, prop: str) -> Array:
        rows = self.rollout.recorder.recording.rows[self._feasibility.felt_from :]
        X_TW = self.world.X_WT.inverse()
        return np.array([X_TW @ row.objects[prop][:3] for row in rows])

    def tried(self, action: Callable[[], object]) -> bool:
        before = self.rollout.steps
        try:
            action()
        except Infeasible as problem:
            if problem.reason not in PLANNING or self.rollout.steps != before:
                raise
            return False
        return True

    def retake(self, action: Callable[[], None]) -> None:
        try:
            action()
            return
        except Infeasible as problem:
            if problem.reason not in LOST or self._recovering:
                raise
            if not self._may_recover:
                raise Infeasible("recovered", f"a second try is due: {problem.detail}") from problem
            loss = problem
        self._recovering = True
        self.hands.care = CARE
        for arm in (self.left, self.right):
            if self.hands.lost(arm.side):
                self.do(arm.open())
                self.tried(lambda arm=arm: self.do(arm.retreat(BACK_OFF)))
                self.do(arm.wait(CALM))
        try:
            action()
        except Infeasible as problem:
            # Where it fell it may be out of reach: that is no failure of planning.
            raise loss if problem.reason in PLANNING else problem from None

    # ---- carrying out ----------------------------------------------------------------------------

    def _together(self, steps: dict[str, Step]) -> None:
        """One step of one or both arms, at the same time."""
        self._feasibility.refresh()
        alone = sum(not isinstance(step, Grip | Wait) for step in steps.values()) == 1
        goals = {s: g for s, step in steps.items() if (g := self._goal(s, step, alone)) is not None}
        grips = {s: step for s, step in steps.items() if isinstance(step, Grip)}
        if grips:
            self._settle()
        ramps = {side: self.hands.ramp(side, grip.opening) for side, grip in grips.items()}
        trajectory = None
        if goals:
            room = max((getattr(step, "room", 0.0) for step in steps.values()), default=0.0)
            checker = self.planner.checker
            with checker.under(checker.rules._replace(carried_margin=room or RESTING_MARGIN)):
                start = {side: self._feasibility.commanded(side) for side in SIDES}
                trajectory = self.planner.motion(start, goals, self.hands.pace())
        touched = self._run(trajectory, steps, ramps)
        for side, step in steps.items():
            if isinstance(step, Shift) and step.must and side not in touched:
                raise Infeasible("stalled", f"the {side} hand did not meet {step.until}")
        for side, grip in grips.items():
            self.hands.closed(side, grip)
        if not grips:
            self.hands.still_held()

    def _goal(self, side: str, step: Step, alone: bool) -> ArmGoal | None:
        """Where a step takes the arm, perhaps alone; None when it keeps still."""
        match step:
            case Home():
                return ArmGoal(q=self.world.robot.arm(side).limb.home)
            case Line():
                return ArmGoal(line=(self.world.X_WT @ step.goal,), speed=step.speed)
            case Follow():
                poses = tuple(self.world.X_WT @ pose for pose in step.poses)
                return ArmGoal(line=poses, seconds=step.seconds)
            case Shift():
                return self._shift_goal(side, step, alone)
            case Reach():
                if step.posture:
                    return ArmGoal(q=np.array(step.posture), speed=step.speed)
                for pose in step.candidates:
                    q = self._feasibility.posture(side, pose)
                    only = len(step.candidates) == 1
                    if q is not None and (only or self._feasibility.clear(side, q, other=None)):
                        return ArmGoal(q=q, speed=step.speed)
                raise Infeasible("unreachable", f"no posture of the {side} arm")
        return None

    def _shift_goal(self, side: str, step: Shift, alone: bool) -> ArmGoal:
        ee = self._feasibility.commanded_ee(side)
        offset = ee.R @ np.asarray(step.offset) if step.tool else np.asarray(step.offset)
        for share in step.shares:
            goal = Pose(ee.p + share * offset, step.turn or ee.q)
            if self._feasibility.follows(side, goal, alone):
                return ArmGoal(line=(self.world.X_WT @ goal,), speed=step.speed)
            if step.turn:  # a large turn may need another branch: go there freely
                q = self._feasibility.posture(side, goal)
                if q is not None:
                    return ArmGoal(q=q, speed=step.speed)
        raise Infeasible("unreachable", f"the {side} hand cannot move by {step.offset}")

    def _run(
        self, trajectory: Trajectory | None, steps: dict[str, Step], ramps: dict[str, Array]
    ) -> set[str]:
        """Carry steps out, with the fingers' commands; which arms have met what to stop at."""
        arms = {side: self.world.robot.arm(side) for side in SIDES}
        openings = {side: ramp.tolist() for side, ramp in ramps.items()}
        paths: dict[str, tuple[list[list[float]], list[list[float]]]] = {}  # as plain floats
        if trajectory is not None:
            for side in steps:
                columns = self.planner.columns[side]
                if not isinstance(steps[side], Grip | Wait):
                    q, qd = trajectory.q[:, columns], trajectory.qd[:, columns]
                    paths[side] = q.tolist(), qd.tolist()
        until = {s: w for s, step in steps.items() if (w := getattr(step, "until", ""))}
        waits = [step.seconds for step in steps.values() if isinstance(step, Wait)]
        length = max(
            len(trajectory) if trajectory is not None else 0,
            *(len(ramp) for ramp in ramps.values()),
            round(max(waits, default=0.0) * 250),
        )
        stopped: set[str] = set()
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
            # A motion ends early once every arm that moves has met what it should stop at.
            if until and not ramps and stopped == set(paths):
                break
        for arm in arms.values():
            arm.stop()
        return stopped

    def _settle(self) -> None:
        """Wait until both arms are where they were told to be."""
        for _ in range(SETTLE_STEPS):
            errors = [np.abs(a.measured() - a.target).max() for a in self.world.robot.arms]
            if max(errors) < SETTLED:
                return
            self.rollout.tick()
