"""What a worker does: one seed, and on a feasible one the baselines."""

from collections.abc import Callable
from dataclasses import dataclass, field, replace

from rtphys.assets.pack import Pack
from rtphys.episode.generate import attempt
from rtphys.episode.replay import actions_of, replay
from rtphys.results.instances import HASH_LENGTH, Slot
from rtphys.setting.recipe import Recipe
from rtphys.task.spec import Task, load_task


@dataclass(frozen=True)
class Job:
    """One seed, and what to measure on it if it is feasible."""

    recipe: Recipe
    baselines: tuple[str, ...]


@dataclass(frozen=True)
class Bench:
    """A worker's equipment: picklable, set up once in each process by calling it."""

    pack: Pack
    tasks: dict[str, Task] = field(default_factory=dict)

    def __call__(self) -> Callable[[Job], Slot]:
        return self.do

    def do(self, job: Job) -> Slot:
        """Lets the expert try, without pictures."""
        recipe = job.recipe
        if recipe.task not in self.tasks:
            self.tasks[recipe.task] = load_task(recipe.task)
        task = self.tasks[recipe.task]
        tried = attempt(recipe, task, self.pack)
        if not tried.accepted or tried.recording is None:
            return Slot(recipe.seed, tried.reason)
        state, alone, twin = tried.recording.hash[:HASH_LENGTH], None, None
        if "replay" in job.baselines:
            alone = replay(recipe, task, self.pack, actions_of(tried.recording))
        if "twin" in job.baselines:
            twin = self._twin(recipe, task)
        return Slot(recipe.seed, "", state, alone, twin)

    def _twin(self, recipe: Recipe, task: Task) -> bool | None:
        """Whether clean actions do under this physics; None if the clean expert fails."""
        clean = attempt(replace(recipe, protocol="clean"), task, self.pack)
        if not clean.accepted or clean.recording is None:
            return None
        return replay(recipe, task, self.pack, actions_of(clean.recording))
