"""What a worker does: one attempt, and its pictures if it is accepted."""

from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path

from rtphys.assemble import assemble, values
from rtphys.assets.pack import Pack
from rtphys.data.staging import StagedEpisode, stage_episode
from rtphys.data.writer import Rejection
from rtphys.errors import Infeasible
from rtphys.generate import attempt
from rtphys.photograph import photograph
from rtphys.physics import Physics
from rtphys.recipe import Recipe
from rtphys.sim import renderer
from rtphys.task.spec import Task, load_task

Result = StagedEpisode | Rejection


@dataclass(frozen=True)
class Job:
    """One attempt and the folder for its files."""

    recipe: Recipe
    folder: Path


@dataclass(frozen=True)
class Desk:
    """A worker's equipment: picklable, set up once in each process by calling it."""

    pack: Pack
    cameras: tuple[str, ...]
    layout: str
    shader: str
    tasks: dict[str, Task] = field(default_factory=dict)

    def __call__(self) -> Callable[[Job], Result]:
        renderer.configure(self.shader)
        renderer.hold_anchor()
        return self.do

    def do(self, job: Job) -> Result:
        """Simulate; draw, encode and stage a success."""
        recipe = job.recipe
        if recipe.task not in self.tasks:
            self.tasks[recipe.task] = load_task(recipe.task)
        task = self.tasks[recipe.task]
        tried = attempt(recipe, task, self.pack)
        if not tried.accepted or tried.recording is None:
            physics = tried.instance.physics if tried.instance else None
            return rejection(recipe, tried.reason, tried.detail, physics)
        pictures = photograph(recipe, task, self.pack, tried.recording, self.cameras)
        return stage_episode(job.folder, assemble(tried, pictures, self.pack), self.layout)


def rejection(
    recipe: Recipe, reason: str, detail: str, physics: Physics | None = None
) -> Rejection:
    """With the physics of the attempt, as far as it can be known without its world."""
    if physics is not None:
        return Rejection(recipe.seed, reason, detail, values(physics))
    try:
        drawn = recipe.domain().sample(recipe.seed, recipe.only, recipe.overrides)
    except Infeasible:
        return Rejection(recipe.seed, reason, detail)
    known = values(drawn)
    known.pop("center_of_mass")  # it is redrawn until it lies inside bodies that nobody built
    return Rejection(recipe.seed, reason, detail, known)
