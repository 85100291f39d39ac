"""A pool of worker processes that may crash, hang or leak without harm to the campaign.

Not `concurrent.futures`: one dead process breaks that pool. Not `multiprocessing`: it runs the
caller's main module again in every worker. Workers are fresh interpreters, since a process that
has forked from a renderer hangs.
"""

import os
import signal
import subprocess
import sys
import tempfile
import time
from collections import deque
from collections.abc import Hashable
from dataclasses import dataclass
from multiprocessing.connection import Connection, Pipe, wait
from pathlib import Path
from typing import Generic, TypeVar

from rtphys.campaign.workers.pool import CRASH, HANG, Done, Lost, WorkerFailed, WorkerPool
from rtphys.campaign.workers.worker import resident_bytes

J = TypeVar("J")
R = TypeVar("R")

# One thread each, because there is a worker a core. (LP: Mesa's CPU renderer.)
THREADS = {"LP_NUM_THREADS": "0", "OMP_NUM_THREADS": "1", "OPENBLAS_NUM_THREADS": "1"}
START_TRIES = 3  # workers in a row that may die before they are ready
LOG_TAIL = 2000  # [characters] of what a dead worker said


@dataclass(eq=False)
class _Job(Generic[J]):
    name: Hashable
    what: J
    own_deaths: int = 0
    foreign_deaths: int = 0


@dataclass(eq=False)
class _Worker(Generic[J]):
    process: subprocess.Popen[bytes]
    line: Connection
    log: Path
    job: _Job[J] | None = None
    since: float = 0.0
    ready: bool = False
    done: int = 0
    killed: str = ""  # why we killed it


@dataclass
class LocalPool(WorkerPool[J, R]):
    """Workers that are child processes on this machine; started when they are first needed."""

    def __post_init__(self) -> None:
        self._workers: list[_Worker[J]] = []
        self._queue: deque[_Job[J]] = deque()
        self._failed_starts = 0
        self._logs = tempfile.TemporaryDirectory(prefix="rtphys-workers-")
        self._spawned = 0

    # ---- the pool ------------------------------------------------------------

    @property
    def busy(self) -> int:
        return len(self._queue) + sum(worker.job is not None for worker in self._workers)

    def submit(self, name: Hashable, job: J) -> None:
        self._queue.append(_Job(name, job))
        self._assign()

    def wait(self, timeout: float = 1.0) -> list[Done[R] | Lost]:
        ended: list[Done[R] | Lost] = []
        lines = {worker.line: worker for worker in self._workers if worker.job is not None}
        for line in wait(list(lines), timeout) if lines else []:
            assert isinstance(line, Connection)
            ended += self._receive(lines[line])
        for worker in list(self._workers):
            self._watch(worker)
        self._assign()
        return ended

    def close(self) -> None:
        for worker in list(self._workers):
            self._remove(worker)
        self._queue.clear()
        self._logs.cleanup()

    # ---- workers ---------------------------------------------------------------------------

    def _assign(self) -> None:
        while self._queue:
            idle = next((worker for worker in self._workers if worker.job is None), None)
            if idle is None and len(self._workers) >= self.size:
                return
            worker = idle or self._spawn()
            worker.job, worker.since = self._queue.popleft(), time.monotonic()
            try:
                worker.line.send(worker.job.what)
            except OSError:  # it died while it was idle; nobody's fault
                self._queue.appendleft(worker.job)
                self._remove(worker)

    def _spawn(self) -> _Worker[J]:
        ours, theirs = Pipe()
        self._spawned += 1
        log = Path(self._logs.name) / f"{self._spawned}.log"
        command = [sys.executable, "-m", "rtphys.campaign.workers.worker"]
        command += [str(theirs.fileno()), str(os.getpid())]
        path = os.pathsep.join(p for p in sys.path if p)
        with log.open("wb") as said:
            process = subprocess.Popen(
                command,
                stdin=subprocess.DEVNULL,
                stdout=said,
                stderr=subprocess.STDOUT,
                pass_fds=[theirs.fileno()],
                env={**os.environ, **THREADS, "PYTHONPATH": path},
                process_group=0,  # Ctrl-C is handled by the parent alone
            )
        theirs.close()
        worker = _Worker[J](process, ours, log)
        self._workers.append(worker)
        ours.send(sys.path)
        ours.send(self.setup)
        return worker

    def _remove(self, worker: _Worker[J]) -> int:
        """Ends a process; returns its exit status."""
        worker.line.close()
        if worker.process.poll() is None:
            worker.process.kill()
        self._workers.remove(worker)
        return worker.process.wait()

    def _watch(self, worker: _Worker[J]) -> None:
        """Kills what takes too long or too much; its death is then heard on its line."""
        if worker.job is None or worker.killed:
            return
        if time.monotonic() - worker.since > self.limits.seconds:
            worker.killed = f"ran longer than {self.limits.seconds:g} s"
        elif resident_bytes(worker.process.pid) > self.limits.most_memory:
            worker.killed = f"used more than {self.limits.most_memory / 1e9:g} GB"
        if worker.killed:
            worker.process.kill()

    # ---- messages of workers ----------------------------------------------------------------

    def _receive(self, worker: _Worker[J]) -> list[Done[R] | Lost]:
        try:
            message = worker.line.recv()
        except (EOFError, OSError):
            return self._handle_death(worker)
        if message[0] == "failed":
            _, text, code, trace = message
            if worker.ready and worker.job is not None:
                text = f"{worker.job.name}: {text}"
            raise WorkerFailed(text, code or 70, "" if code else trace + self._tail(worker))
        if message[0] == "ready":
            worker.ready, self._failed_starts = True, 0
            return []
        _, result, resident = message
        assert worker.job is not None
        name, worker.job = worker.job.name, None
        worker.done += 1
        spent = worker.done >= self.limits.jobs or resident > self.limits.memory
        if spent or worker.killed:  # the kill came a moment too late
            self._remove(worker)
        return [Done(name, result)]

    def _handle_death(self, worker: _Worker[J]) -> list[Done[R] | Lost]:
        """A dead worker's job gets another try, or is given up."""
        status, job = self._remove(worker), worker.job
        assert job is not None
        died = worker.killed or _cause_of_death(status)
        self.notice(f"a worker {died} on {job.name}")
        foreign = not worker.killed and -status in (signal.SIGKILL, signal.SIGTERM)
        if not worker.ready and not worker.killed:
            self._failed_starts += 1
            if self._failed_starts >= START_TRIES:
                text = f"workers {died} while they start: {self._tail(worker) or 'without a word'}"
                raise WorkerFailed(text, 70, "")
        elif foreign:
            job.foreign_deaths += 1
        else:
            job.own_deaths += 1
        limits = self.limits
        if job.own_deaths > limits.retries or job.foreign_deaths > limits.foreign_retries:
            hung = worker.killed.startswith("ran")
            return [Lost(job.name, HANG if hung else CRASH, died)]
        self._queue.appendleft(job)
        return []

    def _tail(self, worker: _Worker[J]) -> str:
        try:
            return worker.log.read_text(errors="replace")[-LOG_TAIL:].strip()
        except OSError:
            return ""


def _cause_of_death(status: int) -> str:
    if status >= 0:
        return f"ended with exit code {status}"
    try:
        return f"was killed by {signal.Signals(-status).name}"
    except ValueError:
        return f"was killed by signal {-status}"


def cores() -> int:
    """CPU cores that this process may use."""
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1
