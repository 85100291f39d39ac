"""A worker pool without processes, for tests of what is done with results."""

from dataclasses import dataclass

import pytest

from rtphys.analysis import sensitivity
from rtphys.campaign import local
from rtphys.campaign.pool import J, Job, R, WorkerError, WorkerFailure, WorkerPool
from rtphys.core.errors import RtphysError
from rtphys.studies import collect


@dataclass
class QuickPool(WorkerPool[J, R]):
    """Does its jobs in this process; what began last ends first."""

    def __post_init__(self) -> None:
        self._do = self.setup()
        self._jobs: list[Job[J, R]] = []
        self.names: list[str] = []  # of all jobs

    def loss(self, job: J) -> str:
        """Why a job takes its workers with it; empty: it does not. For subclasses."""
        return ""

    def _begin(self, job: Job[J, R]) -> None:
        self._jobs.append(job)
        self.names.append(job.name)

    def wait(self, timeout: float = 1.0) -> None:
        job = self._jobs.pop()
        outcome: R | WorkerFailure | WorkerError
        if reason := self.loss(job.content):
            outcome = WorkerFailure(reason, "was killed by SIGKILL")
        else:
            try:
                outcome = self._do(job.content)
            except RtphysError as error:  # as a worker sends it
                outcome = WorkerError(str(error), error.exit_code)
        job.end(outcome)

    def __exit__(self, *_: object) -> None:
        self._jobs.clear()


@pytest.fixture(autouse=True)
def in_process(request: pytest.FixtureRequest, monkeypatch: pytest.MonkeyPatch) -> None:
    """The jobs of a folder's tests are done in this process, unless one is marked `processes`.

    To start workers takes longer than most of these tests.
    """
    if not request.node.get_closest_marker("processes"):
        for module in (local, collect, sensitivity):
            monkeypatch.setattr(module, "LocalPool", QuickPool)
