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
    listener.started([one.tally for one in series])
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
        while (
            pool.room
            and (index := next((i for i, one in enumerate(series) if one.wants(pool.size)), None))
            is not None
        ):
            _begin(series[index], index, pool)
        for one in series:
            one.close_if_over()
        if not any(one.running and not one.over for one in series):
            return
        for event in pool.wait():
            assert isinstance(event.name, Cell)
            one = series[event.name.series]
            if isinstance(event, Done):
                one.take(event.name.seed, event.result)
            else:
                one.lose(event.name.seed, event)
            committed()
            listener.ticked()
        listener.ticked()


def _begin(one: Series[J, R], index: int, pool: WorkerPool[J, R]) -> None:
    seed = one.begin()
    result = one.study.known(seed)
    if result is None:
        pool.submit(Cell(index, one.tally.name, seed), one.study.job(seed))
    else:
        one.take(seed, result)


def _bug(failure: WorkerFailed, folder: Path | None) -> Bug:
    """The traceback goes to a file."""
    place = ""
    if folder is not None:
        log = folder / ERROR_LOG
        with suppress(OSError):
            log.write_text(failure.trace + "\n")
            place = f"; the traceback is in {log}"
    return Bug(f"{failure}. This is a bug in rtphys or in the task{place}")
