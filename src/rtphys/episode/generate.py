"""One episode, one path: recipe -> physics -> world -> script -> success -> verdict."""

from dataclasses import dataclass

from rtphys.assets.pack import Pack
from rtphys.core.errors import Infeasible
from rtphys.core.seeds import stream
from rtphys.core.timing import Laps
from rtphys.episode.instance import Instance, prepare, settle
from rtphys.expert.robot import ExpertRobot
from rtphys.setting.setting import Recipe
from rtphys.sim.recorder import FRAME_STEPS, Recording
from rtphys.sim.rollout import Outcome, Rollout
from rtphys.task.spec import Task

POLL = FRAME_STEPS  # a demonstration's first success is known to one recorded frame, 60 ms


@dataclass(frozen=True, eq=False)
class Attempt:
    """What came of one recipe. `reason` is empty iff it is accepted."""

    recipe: Recipe
    reason: str = ""
    detail: str = ""
    instance: Instance | None = None  # None when not even the world could be made
    recording: Recording | None = None
    outcome: Outcome | None = None

    @property
    def accepted(self) -> bool:
        return not self.reason


def attempt(recipe: Recipe, task: Task, pack: Pack, laps: Laps | None = None) -> Attempt:
    """Let the scripted expert try one episode. Never renders.

    Infeasibility is a result, not an error: this is the only place that catches it.

    Args:
        laps: takes the time of the phases build, settle, plan and simulate.
    """
    instance = rollout = None
    clock = laps or Laps()
    try:
        with clock.phase("build"):
            instance = prepare(recipe, task, pack)
        with clock.phase("settle"):
            settle(instance)
        with clock.phase("plan"):
            rollout = start(instance, POLL)
            if laps is not None:  # every step, which is too often for those who do not ask
                rollout.tick = laps.timed("simulate", rollout.tick)
            chance = stream(recipe.seed, "expert")
            task.script(ExpertRobot(rollout, chance, recipe.setting.recovery))
        with clock.phase("simulate"):
            outcome = rollout.finish()
    except Infeasible as problem:
        recording = rollout.recorder.recording if rollout else None
        return Attempt(recipe, problem.reason, problem.detail, instance, recording)
    recording = rollout.recorder.recording
    if outcome.held:
        return Attempt(recipe, "", "", instance, recording, outcome)
    reason = "failed_check" if outcome.first_success is None else "not_held"
    return Attempt(recipe, reason, "; ".join(outcome.missing), instance, recording, outcome)


def start(instance: Instance, poll: int = 1) -> Rollout:
    """Begin the policy stage of a settled instance."""
    task, world = instance.task, instance.world
    condition = task.condition(list(instance.props))
    return Rollout(world, instance.physics, condition, task.step_limit, poll)
