"""The policy stage of one episode: every step is polled for success and recorded."""

from contextlib import nullcontext
from dataclasses import dataclass
from typing import Literal

from rtphys.core.errors import Infeasible
from rtphys.core.timing import PhaseTimer
from rtphys.physics.values import Physics
from rtphys.sim.engine import RATE
from rtphys.sim.happened import HappenedMonitor
from rtphys.sim.recorder import FRAME_STEPS, Recorder
from rtphys.sim.strain import Strain, StrainMonitor
from rtphys.sim.touch import in_hand
from rtphys.sim.view import SceneView
from rtphys.sim.world import World
from rtphys.task.scene import Scene
from rtphys.task.success import Condition


class Watch:
    """Gives the answers of `condition.holds` at a lower cost.

    A part that did not hold at the last poll mostly does not hold yet, so it is asked first and
    the others need no asking.
    """

    def __init__(self, condition: Condition) -> None:
        parts = condition.parts or (condition,)
        self._remembering = [part for part in parts if part.remembers]
        others = [part for part in parts if not part.remembers]
        # Cheap ones before all others: asking them in vain costs little.
        self._others = [[p for p in others if p.quick], [p for p in others if not p.quick]]

    def holds(self, scene: Scene) -> bool:
        """Whether all parts hold now; those that remember are asked in any case."""
        verdict = True
        for part in self._remembering:
            verdict = part.holds(scene) and verdict
        for parts in self._others if verdict else []:
            for i, part in enumerate(parts):
                if not part.holds(scene):
                    parts.insert(0, parts.pop(i))
                    return False
        return verdict

    def remember(self, scene: Scene) -> None:
        """Show an instant to the parts that remember, without asking the others."""
        for part in self._remembering:
            part.holds(scene)


Keep = Literal["rows", "hash", "nothing"]
HOLD_TIME = 0.5  # [s] success must still hold this long after the end


@dataclass(frozen=True)
class Outcome:
    """How a rollout ended."""

    first_success: float | None  # [s] first instant at which the condition held
    held: bool  # it holds at the end, after HOLD_TIME of keeping still
    missing: tuple[str, ...]  # conditions that do not hold at the end

    @property
    def detail(self) -> str:
        """What does not hold, in one line."""
        return f"not true: {'; '.join(self.missing)}" if self.missing else ""


@dataclass(frozen=True)
class RolloutOptions:
    """How long a rollout may last, and what is kept of it."""

    # Frames of 15 steps that it may last; a demonstration's frame counts as one policy action.
    # None: no limit, because whoever drives the robot has one of their own.
    frame_limit: int | None = None
    # Steps between two looks at the condition; what it must remember is seen at every step all the
    # same. Evaluation looks at every step, as officially.
    poll: int = 1
    # "rows": a row a frame. "hash": only their hash, for whoever shows and stores nothing.
    # "nothing": only the verdict is wanted. The first row is kept in any case.
    keep: Keep = "rows"
    # A motion that no real robot should make ends it ("collision", "overloaded").
    gentle: bool = False
    touch: bool = False  # record what touches the fingers, too
    happened: bool = False  # find out what happened, too; it costs a tenth of a step
    timer: PhaseTimer | None = None  # takes the time of all steps, as the phase "simulate"


class Rollout:
    """A world in its policy stage. Whoever drives the robot calls `tick` once a step."""

    def __init__(
        self, world: World, physics: Physics, condition: Condition, options: RolloutOptions
    ) -> None:
        self.options, self.world, self.condition = options, world, condition
        self._watch = Watch(condition)
        self.scene = SceneView(world, physics)
        friction = in_hand(physics) if options.touch else None
        self.recorder = Recorder(world, self.scene.contacts, friction, options.keep == "rows")
        self._monitor = StrainMonitor(world)
        self.recorder.recording.strain = self._monitor.strain
        self._happened = HappenedMonitor(world) if options.happened else None
        self.recorder.recording.happened = self._happened and self._happened.happened
        self.steps = 0  # of the policy stage
        self.first_success: float | None = None  # [s] first instant at which the condition held
        self._counts_success = True
        world.policy_stage = True

    @property
    def strain(self) -> Strain:
        """The largest loads on the robot so far."""
        return self._monitor.strain

    def tick(self) -> bool:
        """One physics step; True when the success condition holds after it.

        Raises:
            Infeasible: "too_slow", past the limit; "collision" or "overloaded" (`Strain`).
        """
        options = self.options
        with options.timer.phase("simulate") if options.timer else nullcontext():
            self.world.step()
            self.steps += 1
            now = False
            if self.steps % options.poll == 0:
                now = self._watch.holds(self.scene)
            else:
                self._watch.remember(self.scene)
            if now and self.first_success is None and self._counts_success:
                self.first_success = self.scene.time
            if options.keep != "nothing":
                self.recorder.tick(self.steps)
            self._monitor.tick(self.steps)
            if self._happened is not None:
                self._happened.tick(self.steps % FRAME_STEPS == 0)
        if options.gentle and (problem := self.strain.problem):
            raise Infeasible(*problem)
        if options.frame_limit is not None and self.steps > options.frame_limit * FRAME_STEPS:
            seconds = options.frame_limit * FRAME_STEPS / RATE
            raise Infeasible("too_slow", f"not done after {seconds:.1f} s")
        return now

    def finish(self, counts_success: bool = True) -> Outcome:
        """Keep still for HOLD_TIME, then judge.

        The episode is padded to whole frames, so that the last row is the judged state.

        Args:
            counts_success: false: what succeeds only from now on is no `first_success`.
        """
        self._counts_success = counts_success
        self.recorder.enter("hold")
        for _ in range(int(HOLD_TIME * RATE)):
            self.tick()
        while self.steps % FRAME_STEPS:
            self.tick()
        now = self.condition.holds(self.scene)
        missing = () if now else tuple(self.condition.failing(self.scene))
        return Outcome(self.first_success, now, missing)
