"""The worker pool: jobs in, results out. `local.py` and `ray.py` implement it."""

from abc import ABC, abstractmethod
from collections.abc import Callable, Hashable, Sequence
from dataclasses import dataclass, field
from types import TracebackType
from typing import Generic, Self, TypeVar

from rtphys.core.errors import RtphysError

J = TypeVar("J")
R = TypeVar("R")


@dataclass(frozen=True)
class Limits:
    """What a worker may use."""

    seconds: float = 600.0  # [s] wall clock for one job, start-up included
    jobs: int = 200  # then a worker is replaced
    memory: float = 1.5e9  # [bytes] resident after a job; then a worker is replaced
    most_memory: float = 6e9  # [bytes] at any time; then it is killed
    retries: int = 1  # after a crash or a hang that is the job's own doing
    foreign_retries: int = 3  # after a SIGKILL or SIGTERM that somebody else sent


@dataclass(frozen=True)
class Done(Generic[R]):
    """A job's result."""

    name: Hashable
    result: R


CRASH, HANG = LOSSES = "worker_crash", "worker_hang"


@dataclass(frozen=True)
class Lost:
    """A job that took its workers with it. `reason` is one of `LOSSES`."""

    name: Hashable
    reason: str
    detail: str


class WorkerFailed(RtphysError):
    """An exception in a worker. `trace` is empty for an error that a user can cause."""

    def __init__(self, text: str, exit_code: int, trace: str) -> None:
        self.exit_code, self.trace = exit_code, trace
        super().__init__(text)


@dataclass
class WorkerPool(ABC, Generic[J, R]):
    """Takes jobs and gives their results in any order; each job comes back exactly once.

    Use it as a context manager, from one thread that outlives it.

    Args:
        setup: picklable; called once in each worker, returns the function that does a job.
        size: number of worker processes.
        notice: called with one sentence when a worker dies.
    """

    setup: Callable[[], Callable[[J], R]]
    size: int
    limits: Limits = field(default_factory=Limits)
    notice: Callable[[str], None] = lambda _: None

    @property
    def room(self) -> int:
        """Number of jobs that could start now."""
        return self.size - self.busy

    @property
    @abstractmethod
    def busy(self) -> int:
        """Number of jobs that run or wait for another try."""

    @abstractmethod
    def submit(self, name: Hashable, job: J) -> None:
        """Adds a job."""

    @abstractmethod
    def wait(self, timeout: float = 1.0) -> Sequence[Done[R] | Lost]:
        """Jobs that have ended, after at most `timeout` [s].

        Raises:
            WorkerFailed: a worker raised, or cannot even start.
        """

    @abstractmethod
    def close(self) -> None:
        """Kills what still runs. Files of unfinished jobs stay; the folder's owner removes them."""

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        self.close()
