"""Pools of two kinds of workers: what is given on, how many at once, and who is to blame."""

from pathlib import Path

import two_stage_jobs
from two_stage_jobs import Job, Result

from rtphys.campaign.local import LocalPool
from rtphys.campaign.pool import WorkerError, WorkerFailure
from rtphys.campaign.two_stages import TwoStagePool

Outcome = Result | WorkerFailure | WorkerError


def run(jobs: list[Job], group: int = 4) -> dict[Job, Outcome]:
    """What comes of jobs, by one worker that draws."""
    outcomes: dict[Job, Outcome] = {}
    one, two = LocalPool(two_stage_jobs.first, 2), LocalPool(two_stage_jobs.second, 1)
    with TwoStagePool(one, [two], group, two_stage_jobs.done) as pool:
        assert pool.size == 2
        waiting = list(jobs)
        while len(outcomes) < len(jobs):
            while waiting and pool.room:
                job = waiting.pop(0)
                pool.submit(job, job, lambda outcome, job=job: outcomes.__setitem__(job, outcome))
            pool.wait()
        assert pool.busy == 0
    return outcomes


def test_what_waits_is_given_on_together() -> None:
    """The first one keeps its worker so long that others wait for it."""
    found = run(["0 slow", *map(str, range(1, 9))])
    sizes = [one[2] for one in found.values() if isinstance(one, tuple)]
    assert len(sizes) == 9
    assert max(sizes) == 4
    assert len({one[1] for one in found.values() if isinstance(one, tuple)}) == 1


def test_what_needs_no_second_worker_meets_none() -> None:
    assert run(["1 rejected"]) == {"1 rejected": ("1 rejected", 0, 0)}


def test_one_that_fails_in_a_group_takes_nobody_with_it() -> None:
    jobs = ["0 slow", "1", "2 abort", "3", "4 refused", "5"]
    found = run(jobs)
    good, crash, refusal = [jobs[n] for n in (0, 1, 3, 5)], found["2 abort"], found["4 refused"]
    assert all(isinstance(found[job], tuple) for job in good)
    assert isinstance(crash, WorkerFailure) and crash.reason == "worker_crash"
    assert isinstance(refusal, WorkerError) and str(refusal).startswith("4 refused: ")


def test_a_group_whose_worker_somebody_kills_is_done_again(tmp_path: Path) -> None:
    found = run(["0 slow", "1", f"2 killed {tmp_path / 'once'}", "3"])
    assert (tmp_path / "once").exists()
    assert all(isinstance(one, tuple) for one in found.values())
