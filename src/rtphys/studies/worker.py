"""What the workers of all studies have in common: an asset pack, tasks loaded once, the expert."""

from abc import ABC, abstractmethod
from collections.abc import Callable
from dataclasses import dataclass
from importlib import import_module
from typing import Generic

from rtphys.assets.pack import Pack
from rtphys.campaign.pool import J, R, Setup
from rtphys.episode import fingerprint
from rtphys.episode.control import actions_of, replay
from rtphys.episode.generate import Attempt, attempt
from rtphys.spec.episode import Recipe
from rtphys.task.spec import Task, load_task


class LoadedTasks(dict[str, Task]):
    """Tasks by name, each loaded when it is first asked for."""

    def __missing__(self, name: str) -> Task:
        self[name] = load_task(name)
        return self[name]


@dataclass
class StudyWorker(Setup, ABC, Generic[J, R]):
    """Does the jobs of one study. Picklable before its first job, as a task's functions are not;
    called once in each worker process."""

    pack: Pack

    def __post_init__(self) -> None:
        self.tasks = LoadedTasks()

    def __call__(self) -> Callable[[J], R]:
        self.start()
        return self.do

    def warm(self) -> None:
        for name in ("networkx", "scipy.spatial"):  # which wait until they are used
            import_module(name)
        fingerprint.code()

    def start(self) -> None:
        """What a process needs before its first job."""

    @abstractmethod
    def do(self, job: J) -> R:
        """Does one job."""

    def demonstrate(self, recipe: Recipe, touch: bool = False, happened: bool = False) -> Attempt:
        """Lets the expert try, without pictures; `touch` and `happened` as in `attempt`."""
        task = self.tasks[recipe.task]
        return attempt(recipe, task, self.pack, touch=touch, happened=happened)

    def replay(self, recipe: Recipe, demonstration: Attempt) -> bool | None:
        """Whether a demonstration's actions alone succeed; None if the expert failed in it."""
        if not demonstration.accepted or demonstration.recording is None:
            return None
        actions = actions_of(demonstration.recording)
        return replay(recipe, self.tasks[recipe.task], self.pack, actions)
