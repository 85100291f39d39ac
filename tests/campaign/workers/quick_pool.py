"""A worker pool without processes, for tests of what is done with results."""

from dataclasses import dataclass

from rtphys.campaign.workers.pool import Done, J, Job, Lost, R, WorkerPool


@dataclass
class QuickPool(WorkerPool[J, R]):
    """Does its jobs in this process; what began last ends first."""

    def __post_init__(self) -> None:
        self._do = self.setup()
        self._jobs: list[Job[J]] = []

    def loss(self, job: J) -> str:
        """Why a job takes its workers with it; empty: it does not. For subclasses."""
        return ""

    def _begin(self, job: Job[J]) -> None:
        self._jobs.append(job)

    def _poll(self, timeout: float) -> list[Done[R] | Lost]:
        job = self._jobs.pop()
        if reason := self.loss(job.content):
            return [Lost(job.name, reason, "was killed by SIGKILL")]
        return [Done(job.name, self._do(job.content))]

    def close(self) -> None:
        self._jobs.clear()
