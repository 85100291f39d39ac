"""Series of seeds: attempted in any order by many workers, committed in the seeds' order.

What a campaign writes depends on its studies alone, not on the number of workers, nor on how often
it was killed and resumed.
"""

import math
import os
from abc import ABC, abstractmethod
from collections import Counter
from collections.abc import Callable, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, field
from functools import partial
from pathlib import Path
from typing import Generic

from rtphys.campaign.pool import J, R, WorkerError, WorkerFailure, WorkerPool
from rtphys.core.errors import RtphysError

ERROR_LOG = "error.log"

FRUITLESS = 200  # results in a row that do not count, after which a series is given up
LOOKAHEAD = 4  # results a worker may be ahead of the slowest: bounds what waits, also on the disk


@dataclass
class Progress:
    """Counts of what a series has committed, not of results that wait for an earlier seed."""

    name: str  # what the series is called on the screen, such as its task
    wanted: int  # results that count
    accepted: int = 0  # results that count, those of earlier runs included
    attempts: int = 0  # likewise, of all results
    rejections: Counter[str] = field(default_factory=Counter[str])  # of this run, by reason
    fruitless: int = 0  # attempts since the last one that counted
    stopped: str = ""  # why it was given up
    solved: int | None = None  # of `accepted`; None in studies in which only successes count
    by: str = ""  # who tries, where a study has several in turn, such as "baselines"
    made: int = 0  # episodes of this run, where a result stands for several: of twins, of values
    new_accepted: int = field(default=0, init=False)  # of this run
    new_attempts: int = field(default=0, init=False)  # likewise

    @property
    def done(self) -> bool:
        return self.accepted >= self.wanted

    def add(self, reason: str, success: bool | None = None) -> None:
        """Counts one result. `reason`, `success`: as `Series.reason`, `Series.success`."""
        if success is not None:
            self.solved = (self.solved or 0) + success
        self.attempts += 1
        self.new_attempts += 1
        if reason:
            self.rejections[reason] += 1
            self.fruitless += 1
        else:
            self.accepted += 1
            self.new_accepted += 1
            self.fruitless = 0

    def judge(self, exhausted: bool) -> None:
        """Gives up where it is hopeless, or where no seed is left."""
        if not self.done and self.fruitless >= FRUITLESS:
            self.stopped = f"none of the last {self.fruitless} attempts was accepted"
        elif not self.done and exhausted:
            self.stopped = f"the most attempts that were allowed were made: {self.attempts}"


class Series(ABC, Generic[J, R]):
    """The seeds of one goal: which of them run, whose results wait, and when there are enough.

    Args:
        seeds: in the order in which their results are committed.
        owed: how many of the first seeds are done even if the goal is reached; they count nothing.
    """

    def __init__(self, progress: Progress, seeds: Sequence[int], owed: int = 0) -> None:
        self.progress, self.seeds = progress, seeds
        self.halted = ""  # why it is left for another run
        self.running = set[int]()
        self._owed = owed
        self._begun = self._committed = 0  # seeds handed out; seeds done with
        self._waiting = dict[int, R | WorkerError]()  # for an earlier seed
        self._made = set[int]()  # those of them that a job has made
        self._closed = False
        progress.judge(exhausted=not seeds)

    @abstractmethod
    def job(self, seed: int) -> J:
        """What a worker is given."""

    def reason(self, result: R) -> str:
        """Why a result does not count towards the goal; empty if it does."""
        return ""

    def success(self, result: R) -> bool | None:
        """Whether a robot solved its task, in studies where a failure counts as well."""
        return None

    def arrived(self, seed: int, result: R) -> R:
        """Called when a worker hands a result over, which may be long before it is committed."""
        return result

    @abstractmethod
    def commit(self, seed: int, result: R) -> str:
        """Keeps a result; called in the seeds' order. Returns why the series must halt, if so."""

    def known(self, seed: int) -> R | None:
        """A result that was made elsewhere and spares the job."""
        return None

    @abstractmethod
    def lost(self, seed: int, loss: WorkerFailure) -> R | str:
        """The result of a seed that took its workers with it, or why the series must halt."""

    def dropped(self, seed: int) -> None:
        """Called when a seed that nobody needs any more has ended: what it made may go."""

    def close(self) -> None:
        """Called once, when nothing more will be committed. Seeds nobody needs may still run."""

    @property
    def enough(self) -> bool:
        """Complete or given up; what still runs was begun to be on the safe side."""
        return self._committed >= self._owed and (self.progress.done or bool(self.progress.stopped))

    @property
    def over(self) -> bool:
        """Whether nothing more will be committed."""
        return self.enough or bool(self.halted and not self.running)

    def wants(self, workers: int) -> bool:
        """Whether one more seed should begin: as many as the missing results are worth."""
        if self.enough or self.halted or self._begun >= len(self.seeds):
            return False
        if len(self.running) + len(self._made) >= LOOKAHEAD * workers:
            return False
        if self._begun < self._owed:
            return True
        progress = self.progress
        if progress.done or progress.stopped:
            return False
        ready = 0
        for result in self._waiting.values():
            if isinstance(result, WorkerError):  # raised in its turn, if it comes to that
                return False
            ready += not self.reason(result)
        # Expected share of attempts that count, in (0, 1]; optimistic while little is known.
        rate = (progress.new_accepted + 1) / (progress.new_attempts + 1)
        return len(self.running) < math.ceil((progress.wanted - progress.accepted - ready) / rate)

    def begin(self) -> int:
        """The next seed to attempt."""
        seed = self.seeds[self._begun]
        self._begun += 1
        self.running.add(seed)
        return seed

    def take(self, seed: int, outcome: R | WorkerFailure | WorkerError) -> None:
        """Commits a result and those that waited for it; drops those past the last one needed.

        Raises `WorkerError`: a seed's, in its turn: one worker alone would have met the same.
        """
        self.running.discard(seed)
        if self.enough:
            self.dropped(seed)
            return
        result = self.lost(seed, outcome) if isinstance(outcome, WorkerFailure) else outcome
        if isinstance(result, str):
            self.halted = self.halted or result
            return
        failed = isinstance(result, WorkerError)
        self._waiting[seed] = result if failed else self.arrived(seed, result)
        if self.known(seed) is None:
            self._made.add(seed)
        while (first := self.seeds[self._committed]) in self._waiting:
            result = self._waiting.pop(first)
            self._made.discard(first)
            if isinstance(result, WorkerError):
                raise result
            if problem := self.commit(first, result):
                self.halted = problem
                return
            if self._committed >= self._owed:
                self.progress.add(self.reason(result), self.success(result))
            self._committed += 1
            self.progress.judge(exhausted=self._committed >= len(self.seeds))
            if self.enough:
                for surplus in self._waiting:
                    self.dropped(surplus)
                self._waiting.clear()
                self.halted = ""  # a seed past the last one needed was lost
                return

    def close_if_over(self) -> None:
        """Lets the study finish as soon as nothing more will come."""
        if self.over and not self._closed:
            self._closed = True
            self.close()


class Batch(Series[J, R]):
    """Jobs by number, whose results are all that is wanted of them.

    Args:
        failed: the result of a job that took its workers with it.
        solved: whether a result is a success; None: every result is.
        by: as `Progress.by`.
    """

    def __init__(
        self,
        name: str,
        jobs: Mapping[int, J],
        failed: Callable[[J, WorkerFailure], R],
        solved: Callable[[R], bool] | None = None,
        by: str = "",
    ) -> None:
        none_yet = None if solved is None else 0
        super().__init__(Progress(name, len(jobs), solved=none_yet, by=by), tuple(jobs))
        self.jobs, self._failed, self._solved = jobs, failed, solved
        self.results = dict[int, R]()  # by number

    def job(self, seed: int) -> J:
        return self.jobs[seed]

    def commit(self, seed: int, result: R) -> str:
        self.results[seed] = result
        return ""

    def success(self, result: R) -> bool | None:
        return None if self._solved is None else self._solved(result)

    def lost(self, seed: int, loss: WorkerFailure) -> R:
        return self._failed(self.jobs[seed], loss)


# ---- all series on one pool ----------------------------------------------------------------------


class Bug(RtphysError):
    """An exception that no one expected; the traceback lies in a file."""

    exit_code = os.EX_SOFTWARE


class Listener:
    """Hears what happens in a campaign. Every method may be overridden; none may take long."""

    def building(self, done: int, total: int, name: str) -> None:
        """The asset pack is being built."""

    def started(self, progresses: Sequence[Progress]) -> None:
        """Everything is checked; the progresses will change in place."""

    def ticked(self) -> None:
        """Called at least once a second, and after attempts."""

    def noticed(self, text: str) -> None:
        """A worker died or was replaced."""


QUIET = Listener()  # hears all and says nothing


def run_all(
    series: Sequence[Series[J, R]],
    pool: WorkerPool[J, R],
    listener: Listener = QUIET,
    log_folder: Path | None = None,
    committed: Callable[[], None] = lambda: None,
) -> None:
    """Runs every series until it is complete, is given up, or must halt.

    Args:
        log_folder: takes the traceback of an unexpected exception in a worker.
        committed: called after results, and at least once a second.

    Raises `RtphysError`: an error in a worker that a user can cause, or one of the studies' own;
    `Bug`: any other exception in a worker.
    """
    pool.notice = listener.noticed
    listener.started([current.progress for current in series])
    try:
        while True:
            for current in series:
                while pool.room and current.wants(pool.size):
                    seed = current.begin()
                    if (result := current.known(seed)) is not None:
                        current.take(seed, result)
                        continue
                    name = f"{current.progress.name}, seed {seed}"
                    pool.submit(name, current.job(seed), partial(current.take, seed))
                current.close_if_over()
            left = [current for current in series if not current.over]
            # One that wants a seed may wait for room, which surplus seeds of another one take.
            if not any(current.running or current.wants(pool.size) for current in left):
                return
            pool.wait()
            committed()
            listener.ticked()
    except WorkerError as failure:
        if not failure.trace:  # a user can cause it
            raise
        failure.add_note(failure.trace)  # part of the traceback
        place = ""
        with suppress(OSError):
            if log_folder is not None:
                text = failure.trace + "\n"  # any: of paths, of source in any language
                (log_folder / ERROR_LOG).write_text(text, "utf-8", "backslashreplace")
                place = f"; the traceback is in {log_folder / ERROR_LOG}"
        raise Bug(f"{failure}. This is a bug in rtphys or in the task{place}") from failure
