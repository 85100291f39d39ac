"""The campaign engine: every series of a campaign on one worker pool.

What a campaign writes depends on its studies alone, not on the number of workers, nor on how often
it was killed and resumed.
"""

from collections.abc import Callable, Sequence
from contextlib import suppress
from pathlib import Path
from typing import NamedTuple, TypeVar

from rtphys.campaign.series import Series, Tally
from rtphys.campaign.workers.pool import Done, WorkerFailed, WorkerPool
from rtphys.core.errors import RtphysError

J = TypeVar("J")
R = TypeVar("R")

ERROR_LOG = "error.log"


class Bug(RtphysError):
    """An exception that no one expected; the traceback lies in a file."""

    exit_code = 70  # EX_SOFTWARE


class Listener:
    """Hears what happens in a campaign. Every method may be overridden; none may take long."""

    def building(self, done: int, total: int, name: str) -> None:
        """The asset pack is being built."""

    def started(self, tallies: Sequence[Tally]) -> None:
        """Everything is checked; the tallies will change in place."""

    def ticked(self) -> None:
        """Called at least once a second, and after every attempt."""

    def noticed(self, text: str) -> None:
        """A worker died or was replaced."""


class Cell(NamedTuple):
    """One seed of one series, as the worker pool knows it."""

    series: int
    label: str
    seed: int

    def __str__(self) -> str:
        return f"{self.label}, seed {self.seed}"


def run_all(
    series: Sequence[Series[J, R]],
    pool: WorkerPool[J, R],
    listener: Listener,
    log_folder: Path | None = None,
    committed: Callable[[], None] = lambda: None,
) -> None:
    """Runs every series until it is complete, is given up, or must halt.

    Args:
        log_folder: takes the traceback of an unexpected exception in a worker.
        committed: called after every result.

    Raises:
        RtphysError: an error in a worker that a user can cause, or one of the studies' own.
        Bug: any other exception in a worker.
    """
    listener.started([current.tally for current in series])
    try:
        _supervise(series, pool, listener, committed)
    except WorkerFailed as failure:
        if not failure.trace:  # a user can cause it
            raise
        raise _bug(failure, log_folder) from failure


def _supervise(
    series: Sequence[Series[J, R]],
    pool: WorkerPool[J, R],
    listener: Listener,
    committed: Callable[[], None],
) -> None:
    while True:
        while pool.room and (index := _next_to_begin(series, pool.size)) is not None:
            _begin(series[index], index, pool)
        for current in series:
            current.close_if_over()
        if not any(current.running and not current.over for current in series):
            return
        for event in pool.wait():
            assert isinstance(event.name, Cell)
            current = series[event.name.series]
            if isinstance(event, Done):
                current.take(event.name.seed, event.result)
            else:
                current.lose(event.name.seed, event)
            committed()
            listener.ticked()
        listener.ticked()


def _next_to_begin(series: Sequence[Series[J, R]], workers: int) -> int | None:
    """Number of the first series that wants a seed to begin."""
    return next((n for n, current in enumerate(series) if current.wants(workers)), None)


def _begin(current: Series[J, R], index: int, pool: WorkerPool[J, R]) -> None:
    seed = current.begin()
    result = current.study.known(seed)
    if result is None:
        pool.submit(Cell(index, current.tally.name, seed), current.study.job(seed))
    else:
        current.take(seed, result)


def _bug(failure: WorkerFailed, folder: Path | None) -> Bug:
    """The traceback goes to a file."""
    place = ""
    if folder is not None:
        log = folder / ERROR_LOG
        with suppress(OSError):
            log.write_text(failure.trace + "\n")
            place = f"; the traceback is in {log}"
    return Bug(f"{failure}. This is a bug in rtphys or in the task{place}")
