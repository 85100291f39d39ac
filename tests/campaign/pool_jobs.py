"""What the pools of test_local and test_ray do, and what comes of it; workers import this file."""

import atexit
import os
import signal
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import partial
from pathlib import Path

from rtphys.campaign.pool import WorkerError, WorkerFailure, WorkerPool
from rtphys.core.errors import BadValue
from rtphys.core.library import load_file


@dataclass(frozen=True)
class Trouble:
    """A job: `what` happens the first `times` times, then it succeeds."""

    what: str = ""
    marks: str = ""  # a folder in which tries are counted
    times: int = 1_000_000


Outcome = int | WorkerFailure | WorkerError


def outcomes(pool: WorkerPool[Trouble, int], jobs: Sequence[Trouble]) -> dict[int, Outcome]:
    """Job number -> its result, which is a process, or its loss."""
    found: dict[int, Outcome] = {}
    for number, job in enumerate(jobs):
        while not pool.room:
            pool.wait()
        pool.submit(str(number), job, partial(found.__setitem__, number))
    drain(pool)
    return found


def drain(pool: WorkerPool[Trouble, int]) -> None:
    while pool.busy:
        pool.wait()


def setup() -> Callable[[Trouble], int]:
    return do


def broken_setup() -> Callable[[Trouble], int]:
    raise BadValue("pack", "nowhere", "it must be somewhere")


def dying_setup() -> Callable[[Trouble], int]:
    print("no driver, no cry", flush=True)
    os.abort()


def hanging_setup() -> Callable[[object], int]:
    time.sleep(3600)
    raise AssertionError


def killed_setup() -> Callable[[Trouble], int]:
    os.kill(os.getpid(), signal.SIGKILL)
    raise AssertionError


def do(job: Trouble) -> int:
    if job.what and _tries(job) < job.times:
        act(job.what)
    return os.getpid()


def _tries(job: Trouble) -> int:
    if not job.marks:
        return 0
    number = len(list(Path(job.marks).iterdir()))
    (Path(job.marks) / str(number)).touch()
    return number


def act(what: str) -> None:
    if what.startswith("farewell:"):
        atexit.register(Path(what.removeprefix("farewell:")).touch)
    elif what == "print":
        print("hello\nworld")
    elif what == "abort":
        os.abort()
    elif what == "killed":
        os.kill(os.getpid(), signal.SIGKILL)
    elif what == "exit":
        os._exit(3)
    elif what == "parent":
        os.kill(os.getppid(), signal.SIGKILL)
        time.sleep(60)
    elif what.startswith("fork:"):
        if not (child := os.fork()):
            time.sleep(60)
            os._exit(0)
        Path(what.removeprefix("fork:"), str(child)).touch()
        os.abort()
    elif what == "nap":
        time.sleep(1)
    elif what == "spin":
        while True:
            pass
    elif what == "sleep":
        while True:
            time.sleep(60)
    elif what == "broken pipe":
        raise BrokenPipeError("the policy's server has gone")
    elif what.startswith("task:"):
        load_file(Path(what.removeprefix("task:")), "task").play()
    elif what == "bug":
        raise TypeError("a cat is no dog")
    elif what == "refusal":
        raise BadValue("friction", -1, "it is a number in [0, 4]")
    elif what == "leak":
        hoard.append(bytearray(200_000_000))
    elif what == "hoard":
        hoard.append(bytearray(b"1") * 400_000_000)
        time.sleep(60)


hoard: list[bytearray] = []
