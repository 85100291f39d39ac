"""What a worker does: the attempts of one seed, and their pictures if all are accepted."""

from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path

from rtphys.assets.pack import Pack
from rtphys.core.errors import Infeasible
from rtphys.data.staging import StagedEpisode, stage_episode
from rtphys.data.writer import Rejection
from rtphys.episode.assemble import assemble, values
from rtphys.episode.generate import Attempt, attempt
from rtphys.episode.photograph import photograph
from rtphys.physics import Physics
from rtphys.setting.recipe import Recipe
from rtphys.sim import renderer
from rtphys.task.spec import Task, load_task

Result = StagedEpisode | Rejection
Results = tuple[Result, ...]


@dataclass(frozen=True)
class Job:
    """One seed: a recipe for each leaf, and the folders for their files."""

    recipes: tuple[Recipe, ...]
    folders: tuple[Path, ...]


@dataclass(frozen=True)
class Desk:
    """A worker's equipment: picklable, set up once in each process by calling it."""

    pack: Pack
    cameras: tuple[str, ...]
    layout: str
    shader: str
    tasks: dict[str, Task] = field(default_factory=dict)

    def __call__(self) -> Callable[[Job], tuple[Result, ...]]:
        renderer.configure(self.shader)
        renderer.hold_anchor()
        return self.do

    def do(self, job: Job) -> tuple[Result, ...]:
        """Simulate all recipes; draw, encode and stage when every one succeeds."""
        tried = self.attempt(job.recipes)
        if not all(one.accepted for one in tried):
            return tuple(_refused(one, tried) for one in tried)
        return tuple(self.stage(*pair) for pair in zip(tried, job.folders, strict=True))

    def attempt(self, recipes: tuple[Recipe, ...]) -> list[Attempt]:
        """Without pictures."""
        return [attempt(one, self._task(one), self.pack) for one in recipes]

    def _task(self, recipe: Recipe) -> Task:
        if recipe.task not in self.tasks:
            self.tasks[recipe.task] = load_task(recipe.task)
        return self.tasks[recipe.task]

    def stage(self, tried: Attempt, folder: Path) -> StagedEpisode:
        """Draws and encodes an accepted attempt."""
        recipe, recording = tried.recipe, tried.recording
        assert recording is not None
        pictures = photograph(recipe, self._task(recipe), self.pack, recording, self.cameras)
        return stage_episode(folder, assemble(tried, pictures, self.pack), self.layout)


def _refused(one: Attempt, tried: list[Attempt]) -> Rejection:
    """Its own reason, or its twin's: half a pair is no episode."""
    physics = one.instance.physics if one.instance else None
    if not one.accepted:
        return rejection(one.recipe, one.reason, one.detail, physics)
    other = next(twin for twin in tried if not twin.accepted)
    why = f"under {other.recipe.protocol}: {other.reason}"
    return rejection(one.recipe, "untwinned", why, physics)


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
