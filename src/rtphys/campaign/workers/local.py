"""A pool of worker processes that may crash, hang or leak without harm to the campaign.

Not `concurrent.futures`: one dead process breaks that pool. Not `multiprocessing`: it runs the
caller's main module again in every worker. Workers are fresh interpreters, since a process that
has forked from a renderer hangs.
"""

import os
import signal
import subprocess
import sys
import time
from dataclasses import dataclass, field
from multiprocessing.connection import Connection, Pipe, wait
from pathlib import Path
from tempfile import TemporaryFile
from typing import IO, Generic, TypeVar

from rtphys.campaign.workers.pool import CRASH, HANG, Done, Job, Lost, WorkerFailed, WorkerPool

J = TypeVar("J")
R = TypeVar("R")

# One thread each, because there is a worker a core. (LP: Mesa's CPU renderer.)
THREADS = {"LP_NUM_THREADS": "0", "OMP_NUM_THREADS": "1", "OPENBLAS_NUM_THREADS": "1"}
RETRIES = 1  # after a crash or a hang that is the job's own doing
FOREIGN_RETRIES = 3  # after a SIGKILL or SIGTERM that somebody else sent
LOG_TAIL = 2000  # [bytes] of what a dead worker said


@dataclass(eq=False)
class _Worker(Generic[J]):
    process: subprocess.Popen[bytes]
    line: Connection
    log: IO[bytes]
    job: Job[J] | None = None
    since: float = 0.0
    ready: bool = False
    done: int = 0
    killed: str = ""  # why we killed it

    def last_words(self) -> str:
        # `seek` would move the worker's own place in the file.
        end = os.fstat(self.log.fileno()).st_size
        text = os.pread(self.log.fileno(), LOG_TAIL, max(end - LOG_TAIL, 0))
        return text.decode(errors="replace").strip()


@dataclass
class LocalPool(WorkerPool[J, R]):
    """Workers that are child processes on this machine; started when they are first needed."""

    _workers: list[_Worker[J]] = field(default_factory=list[_Worker[J]], init=False)

    def close(self) -> None:
        for worker in list(self._workers):
            self._remove(worker)

    def _begin(self, job: Job[J]) -> None:
        idle = next((worker for worker in self._workers if worker.job is None), None)
        worker = idle or self._spawn()
        worker.job, worker.since = job, time.monotonic()
        try:
            worker.line.send(job.content)
        except OSError:  # it died while it was idle; nobody's fault
            self._remove(worker)
            self._begin(job)

    def _spawn(self) -> _Worker[J]:
        ours, theirs = Pipe()
        log = TemporaryFile()  # noqa: SIM115 - `_remove` closes it
        program = (sys.executable, "-m", "rtphys.campaign.workers.worker")
        process = subprocess.Popen(
            [*program, str(theirs.fileno()), str(os.getpid())],
            stdin=subprocess.DEVNULL,
            stdout=log,
            stderr=subprocess.STDOUT,
            pass_fds=[theirs.fileno()],
            env={**os.environ, **THREADS, "PYTHONPATH": os.pathsep.join(p for p in sys.path if p)},
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
        worker.log.close()
        worker.process.kill()
        self._workers.remove(worker)
        return worker.process.wait()

    def _poll(self, timeout: float) -> list[Done[R] | Lost | None]:
        busy = [worker for worker in self._workers if worker.job is not None]
        heard = wait([worker.line for worker in busy], timeout)
        events = [self._receive(worker) for worker in busy if worker.line in heard]
        for worker in self._workers:
            if worker.job is not None and not worker.killed:
                self._watch(worker)
        return events

    def _watch(self, worker: _Worker[J]) -> None:
        """Kills what takes too long or too much; its death is then heard on its line."""
        if time.monotonic() - worker.since > self.limits.seconds:
            worker.killed = f"ran longer than {self.limits.seconds:g} s"
        elif resident_bytes(worker.process.pid) > self.limits.most_memory:
            worker.killed = f"used more than {self.limits.most_memory / 1e9:g} GB"
        if worker.killed:
            worker.process.kill()

    def _receive(self, worker: _Worker[J]) -> Done[R] | Lost | None:
        job = worker.job
        assert job is not None
        try:
            message = worker.line.recv()
        except (EOFError, OSError):
            return self._handle_death(worker, job)
        if isinstance(message, WorkerFailed):
            text = f"{job.name}: {message}" if worker.ready else str(message)
            trace = message.trace and message.trace + worker.last_words()
            raise WorkerFailed(text, message.exit_code, trace)
        if not worker.ready:  # the first message says that it is, and no more
            worker.ready, self.failed_starts = True, 0
            return None
        worker.job, worker.done = None, worker.done + 1
        spent = resident_bytes(worker.process.pid) > self.limits.memory
        if spent or worker.done >= self.limits.jobs or worker.killed:  # killed a moment too late
            self._remove(worker)
        return Done(job.name, message)

    def _handle_death(self, worker: _Worker[J], job: Job[J]) -> Lost | None:
        """A dead worker's job gets another try, or is given up."""
        said, status = worker.last_words(), self._remove(worker)
        killer = next((s.name for s in signal.Signals if s == -status), f"signal {-status}")
        died = f"ended with exit code {status}" if status >= 0 else f"was killed by {killer}"
        died = worker.killed or died
        self.notice(f"a worker {died} on {job.name}")
        if not worker.ready and not worker.killed:
            words = said or "without a word"
            self._count_failed_start(f"workers {died} while they start: {words}")
        elif not worker.killed and -status in (signal.SIGKILL, signal.SIGTERM):
            job.foreign_deaths += 1
        else:
            job.own_deaths += 1
        if job.own_deaths > RETRIES or job.foreign_deaths > FOREIGN_RETRIES:
            return Lost(job.name, HANG if worker.killed.startswith("ran") else CRASH, died)
        self._begin(job)
        return None


def resident_bytes(pid: int) -> int:
    """Memory of a process that is not swapped out; 0 where the kernel does not say."""
    try:
        pages = int(Path(f"/proc/{pid}/statm").read_text().split()[1])
    except OSError:
        return 0
    return pages * os.sysconf("SC_PAGE_SIZE")


def cores() -> int:
    """CPU cores that this process may use."""
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1
