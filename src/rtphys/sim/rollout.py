"""The policy stage of one episode: every step is polled for success and recorded."""

from dataclasses import dataclass

from rtphys.core.errors import Infeasible
from rtphys.physics.values import Physics
from rtphys.sim.engine import RATE
from rtphys.sim.recorder import FRAME_STEPS, Recorder
from rtphys.sim.view import SceneView
from rtphys.sim.watch import Watch
from rtphys.sim.world import World
from rtphys.task.success import Condition

HOLD_TIME = 0.5  # [s] success must still hold this long after the end


@dataclass(frozen=True)
class Outcome:
    """How a rollout ended."""

    first_success: float | None  # [s] first instant at which the condition held
    held: bool  # it holds at the end, after HOLD_TIME of keeping still
    missing: tuple[str, ...]  # conditions that do not hold at the end


class Rollout:
    """A world in its policy stage. Whoever drives the robot calls `tick` once a step."""

    def __init__(
        self, world: World, physics: Physics, condition: Condition, step_limit: int, poll: int = 1
    ) -> None:
        """
        Args:
            step_limit: policy actions (one a frame) that the task allows.
            poll: steps between two looks at the condition; what it must remember is seen at
                every step all the same. Evaluation looks at every step, as officially.
        """
        self.poll = poll
        self.world, self.condition = world, condition
        self._watch = Watch(condition)
        self.scene = SceneView(world, physics)
        self.recorder = Recorder(world, self.scene.contacts)
        self.records = True  # false: only the verdict is wanted
        self.steps = 0  # of the policy stage
        self.max_steps = step_limit * FRAME_STEPS
        self.first_success: float | None = None
        world.policy_stage = True

    def tick(self) -> bool:
        """One physics step; True when the success condition holds after it.

        Raises:
            Infeasible: "too_slow", past the task's step limit.
        """
        self.world.step()
        self.steps += 1
        if self.steps % self.poll == 0:
            now = self._watch.holds(self.scene)
        else:
            now = False
            self._watch.remember(self.scene)
        if now and self.first_success is None:
            self.first_success = self.scene.time
        if self.records:
            self.recorder.tick(self.steps)
        if self.steps > self.max_steps:
            raise Infeasible("too_slow", f"not done after {self.max_steps / RATE:.1f} s")
        return now

    def finish(self) -> Outcome:
        """Keep still for HOLD_TIME, then judge.

        The episode is padded to whole frames, so that the last row is the judged state.
        """
        self.recorder.enter("hold")
        for _ in range(int(HOLD_TIME * RATE)):
            self.tick()
        while self.steps % FRAME_STEPS:
            self.tick()
        now = self.condition.holds(self.scene)
        missing = () if now else tuple(self.condition.failing(self.scene))
        return Outcome(self.first_success, now, missing)
