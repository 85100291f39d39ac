"""What the workers of all studies have in common: an asset pack, and tasks loaded once."""

from abc import ABC, abstractmethod
from collections.abc import Callable
from dataclasses import dataclass
from typing import Generic, TypeVar

from rtphys.assets.pack import Pack
from rtphys.task.spec import Task, load_task

J = TypeVar("J")
R = TypeVar("R")


class LoadedTasks(dict[str, Task]):
    """Tasks by name, each loaded when it is first asked for. Pickles empty."""

    def __missing__(self, name: str) -> Task:
        self[name] = load_task(name)
        return self[name]

    def __reduce__(self) -> tuple[type["LoadedTasks"], tuple[()]]:
        return LoadedTasks, ()  # a task's functions do not pickle


@dataclass
class StudyWorker(ABC, Generic[J, R]):
    """Does the jobs of one study. Picklable; called once in each worker process."""

    pack: Pack

    def __post_init__(self) -> None:
        self.tasks = LoadedTasks()

    def __call__(self) -> Callable[[J], R]:
        self.start()
        return self.do

    def start(self) -> None:
        """What a process needs before its first job."""
        return

    @abstractmethod
    def do(self, job: J) -> R:
        """Does one job."""
