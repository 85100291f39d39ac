"""The worker pool: jobs in, results out. `local.py` and `ray.py` implement it.

Our own: neither `pebble` nor `loky` limits a job's CPU time, tells a crash from a kill by somebody
else, forks workers from a warmed process, or knows Ray.
"""

import os
from abc import ABC, abstractmethod
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Generic, Self, TypeVar

from rtphys.core.errors import RtphysError

J = TypeVar("J")
R = TypeVar("R")

CRASH, HANG = LOSSES = "worker_crash", "worker_hang"
START_TRIES = 3  # workers in a row that may die before they are ready


class Setup:
    """What makes a worker may be more than a function: something to do before, and after."""

    def warm(self) -> None:
        """Loads what all workers need into the process that they are forked from: no threads, no
        devices."""

    def finish(self) -> None:
        """Closes what the jobs have left open; the process ends after it."""


@dataclass(frozen=True)
class Limits:
    """What a worker may use. A job's time begins when its worker has it and is ready."""

    seconds: float = 600.0  # [s] of CPU time for one job
    patience: float = 6000.0  # [s] of wall clock for one job, less what it waits for a core
    user_code: bool = False  # a job out of patience fails; else the machine is overloaded
    jobs: int = 200  # then a worker is replaced
    memory: float = 1.5e9  # [bytes] resident after a job; then a worker is replaced
    max_memory: float = 6e9  # [bytes] at any time; then it is killed


@dataclass(frozen=True)
class WorkerFailure:
    """What comes of a job that took its workers with it. `reason` is one of `LOSSES`."""

    reason: str
    detail: str

    def __str__(self) -> str:
        return f"its worker was lost ({self.reason}: {self.detail})"


class WorkerError(RtphysError):
    """An exception in a worker. `trace` is empty for an error that a user can cause."""

    def __init__(self, text: str, exit_code: int = os.EX_SOFTWARE, trace: str = "") -> None:
        self.exit_code, self.trace = exit_code, trace
        super().__init__(text)


class CannotStart(WorkerError):
    """A worker raised before its first job, or workers die before they are ready."""


@dataclass(eq=False)
class Job(Generic[J, R]):
    """A job that has not ended, and what it has met."""

    name: str
    content: J
    end: Callable[[R | WorkerFailure | WorkerError], None]
    own_deaths: int = 0  # of workers, by its own doing
    foreign_deaths: int = 0  # by somebody else's
    beside: int = 10**6  # other jobs that may run beside it
    not_before: float = 0.0  # on the monotonic clock: when it may be tried again


@dataclass
class WorkerPool(ABC, Generic[J, R]):
    """Takes jobs and gives their results in any order; each job ends exactly once.

    Use it as a context manager, from one thread that outlives it.

    Args:
        setup: picklable; called once in each worker, returns the function that does a job.
        size: number of worker processes.
        notice: called with one sentence when a worker dies; `run_all` sets it.
    """

    setup: Callable[[], Callable[[J], R]]
    size: int
    limits: Limits = field(default_factory=Limits)
    notice: Callable[[str], None] = lambda _: None
    busy: int = field(default=0, init=False)  # jobs that run or wait for another try
    failed_starts: int = field(default=0, init=False)  # in a row

    @property
    def room(self) -> int:
        """Number of jobs that may be submitted now."""
        return self.size - self.busy

    def submit(
        self, name: str, job: J, end: Callable[[R | WorkerFailure | WorkerError], None]
    ) -> None:
        """Adds a job; `wait` will call `end` with what comes of it."""

        def count_and_end(outcome: R | WorkerFailure | WorkerError) -> None:
            self.busy -= 1
            end(outcome)

        assert self.room > 0
        self.busy += 1
        self._begin(Job(name, job, count_and_end))

    @abstractmethod
    def _begin(self, job: Job[J, R]) -> None:
        """Gives a job to a worker as soon as there is one for it."""

    @abstractmethod
    def wait(self, timeout: float = 1.0) -> None:
        """Ends jobs, after at most `timeout` [s].

        Raises `CannotStart`: no worker can. What a job raises is given to its `end`.
        """

    def count_failed_start(self, text: str) -> None:
        """Another worker died before it was ready; gives up when that happens again and again."""
        self.failed_starts += 1
        if self.failed_starts >= START_TRIES:
            raise CannotStart(text)

    def __enter__(self) -> Self:
        return self

    @abstractmethod
    def __exit__(self, *_: object) -> None:
        """Kills what still runs. Files of unfinished jobs stay; the folder's owner removes them."""
