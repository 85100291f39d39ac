"""A worker pool without processes, for tests of what is done with results."""

from collections.abc import Hashable
from dataclasses import dataclass
from typing import TypeVar

from rtphys.campaign.workers.pool import Done, Lost, WorkerPool

J = TypeVar("J")
R = TypeVar("R")


@dataclass
class QuickPool(WorkerPool[J, R]):
    """Does its jobs in this process; what began last ends first."""

    def __post_init__(self) -> None:
        self._do = self.setup()
        self._jobs: list[tuple[Hashable, J]] = []

    def loss(self, job: J) -> str:
        """Why a job takes its workers with it; empty: it does not. For subclasses."""
        return ""

    @property
    def busy(self) -> int:
        return len(self._jobs)

    def submit(self, name: Hashable, job: J) -> None:
        assert self.room > 0
        self._jobs.append((name, job))

    def wait(self, timeout: float = 1.0) -> list[Done[R] | Lost]:
        name, job = self._jobs.pop()
        if reason := self.loss(job):
            return [Lost(name, reason, "was killed by SIGKILL")]
        return [Done(name, self._do(job))]

    def close(self) -> None:
        self._jobs.clear()
