"""What the workers of all studies share."""

import pickle
from dataclasses import dataclass

import pytest

from rtphys.assets.pack import Pack
from rtphys.core.errors import UnknownName
from rtphys.studies.worker import LoadedTasks, StudyWorker


@dataclass
class Namer(StudyWorker[str, str]):
    """Names a task."""

    prefix: str = ""
    started: int = 0

    def start(self) -> None:
        self.started += 1

    def do(self, job: str) -> str:
        return f"{self.prefix}{self.tasks[job].name}"


def test_a_task_is_loaded_once_and_when_it_is_asked_for() -> None:
    tasks = LoadedTasks()
    assert not tasks
    assert tasks["lift_pot"] is tasks["lift_pot"]
    assert list(tasks) == ["lift_pot"]
    with pytest.raises(UnknownName, match="did you mean 'lift_pot'"):
        _ = tasks["lift_pt"]


def test_a_worker_goes_to_its_process_without_tasks(pack: Pack) -> None:
    again = pickle.loads(pickle.dumps(Namer(pack, "task ")))
    assert (again.tasks, again.pack.digest) == ({}, pack.digest)
    assert again.do("lift_pot") == "task lift_pot"


def test_it_is_started_before_its_first_job(pack: Pack) -> None:
    worker = Namer(pack)
    do = worker()
    assert worker.started == 1
    assert [do("lift_pot"), do("click_bell")] == ["lift_pot", "click_bell"]
    assert worker.started == 1
