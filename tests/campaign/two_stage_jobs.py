"""What the pools of test_two_stages do; workers import this file."""

import os
import signal
import time
from collections.abc import Callable, Sequence
from pathlib import Path

from rtphys.core.errors import BadValue

Job = str  # "12", or "12 WORD [FILE]": what its second worker meets

Result = tuple[str, int, int]  # the job, its second worker, and how many it did at once


def first() -> Callable[[Job], Job]:
    return lambda job: job


def second() -> Callable[[Sequence[Job]], Sequence[Result]]:
    return finish


def done(job: Job) -> Result | None:
    """A job that needs no second worker."""
    return (job, 0, 0) if job.endswith("rejected") else None


def finish(jobs: Sequence[Job]) -> Sequence[Result]:
    for job in jobs:
        _, what, *file = f"{job} nothing".split()[:3]
        if what == "slow":
            time.sleep(0.5)
        elif what == "abort":
            os.abort()
        elif what == "refused":
            raise BadValue("friction", -1, "a positive number")
        elif what == "killed" and not Path(file[0]).exists():
            Path(file[0]).touch()
            os.kill(os.getpid(), signal.SIGKILL)
    return [(job, os.getpid(), len(jobs)) for job in jobs]
