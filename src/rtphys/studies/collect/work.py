"""What a worker of a collection does: attempt one seed, and draw it if it is accepted."""

from dataclasses import dataclass
from pathlib import Path

from rtphys.core.errors import Infeasible
from rtphys.data.staging import StagedEpisode, stage_episode
from rtphys.data.writer import Rejection
from rtphys.episode.assemble import assemble, values
from rtphys.episode.generate import Attempt, attempt
from rtphys.episode.instance import Instance
from rtphys.episode.photograph import photograph
from rtphys.setting.setting import Recipe
from rtphys.sim import renderer
from rtphys.studies.worker import StudyWorker
from rtphys.task.spec import load_task

Result = StagedEpisode | Rejection
Results = tuple[Result, ...]


@dataclass(frozen=True)
class Job:
    """One seed: the recipe of each side, what is recorded, and folders for the files."""

    recipes: tuple[Recipe, ...]
    folders: tuple[Path, ...]
    cameras: tuple[str, ...]
    layout: str


@dataclass
class CollectWorker(StudyWorker[Job, Results]):
    """Attempts a seed, and draws it with a shader."""

    shader: str = "slim"

    def start(self) -> None:
        renderer.configure(self.shader)
        renderer.hold_anchor()

    def do(self, job: Job) -> Results:
        """Simulates all recipes; draws, encodes and stages when every one succeeds."""
        attempts = self.attempt(job.recipes)
        if not all(tried.accepted for tried in attempts):
            return tuple(_refused(tried, attempts) for tried in attempts)
        return self.stage(attempts, job)

    def attempt(self, recipes: tuple[Recipe, ...]) -> list[Attempt]:
        """Without pictures."""
        return [attempt(recipe, self.tasks[recipe.task], self.pack) for recipe in recipes]

    def stage(self, attempts: list[Attempt], job: Job) -> tuple[StagedEpisode, ...]:
        """Draws and encodes accepted attempts."""
        staged: list[StagedEpisode] = []
        for tried, folder in zip(attempts, job.folders, strict=True):
            recipe, recording = tried.recipe, tried.recording
            assert recording is not None
            task = self.tasks[recipe.task]
            pictures = photograph(recipe, task, self.pack, recording, job.cameras)
            episode = assemble(tried, pictures, self.pack)
            staged.append(stage_episode(folder, episode, job.layout))
        return tuple(staged)


def _refused(tried: Attempt, attempts: list[Attempt]) -> Rejection:
    """Its own reason, or its twin's: half a pair is no episode."""
    if not tried.accepted:
        return rejection(tried.recipe, tried.reason, tried.detail, tried.instance)
    other = next(twin for twin in attempts if not twin.accepted)
    why = f"under {other.recipe.protocol}: {other.reason}"
    return rejection(tried.recipe, "untwinned", why, tried.instance)


def rejection(
    recipe: Recipe, reason: str, detail: str, instance: Instance | None = None
) -> Rejection:
    """With the physics of the attempt, as far as it can be known without its world."""
    if instance is not None:
        known = values(instance.physics, instance.props)
        return Rejection(recipe.seed, reason, detail, known)
    try:
        drawn, props = recipe.setting.draw(recipe.seed), load_task(recipe.task).props(recipe.seed)
    except Infeasible:
        return Rejection(recipe.seed, reason, detail)
    known = values(drawn, props)
    # It is redrawn until it lies inside bodies that nobody built.
    known.pop("center_of_mass", None)
    return Rejection(recipe.seed, reason, detail, known)
