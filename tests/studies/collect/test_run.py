"""A collection that is killed, resumed or repeated: the same files whatever happens."""

import shutil
from dataclasses import replace
from pathlib import Path

import pytest
from collecting import PLAN, Striker, complete, content, kill_one, worker_processes
from killing import survive

from rtphys.data.dataset import Dataset
from rtphys.studies.collect import collect
from rtphys.studies.requests import Run

pytestmark = [pytest.mark.sim, pytest.mark.render]


def test_two_workers_one_of_them_killed_give_the_same_files(
    undisturbed: Path, tmp_path: Path
) -> None:
    # Later it may be one with nothing left to do, whom nobody misses.
    striker = Striker(lambda: kill_one(worker_processes()), early=True)
    assert complete(collect([PLAN], Run(tmp_path / "data", workers=2), striker))
    assert striker.struck and len(striker.told) == 1
    assert content(tmp_path / "data") == content(undisturbed)


def test_a_resumed_run_gives_the_same_files(undisturbed: Path, tmp_path: Path) -> None:
    out = tmp_path / "data"
    assert complete(collect([replace(PLAN, episodes=1)], Run(out, workers=1)))
    assert len(Dataset(out)) == 1
    progresses = collect([PLAN], Run(out, workers=2))
    assert progresses[0].accepted - progresses[0].new_accepted == 1
    assert content(out) == content(undisturbed)


def test_a_complete_dataset_is_left_alone(undisturbed: Path, tmp_path: Path) -> None:
    out = tmp_path / "data"
    shutil.copytree(undisturbed, out)
    progresses = collect([PLAN], Run(out, workers=1))
    assert progresses[0].new_attempts == 0
    assert content(out) == content(undisturbed)


@pytest.mark.slow
def test_killed_runs_end_in_the_same_files(tmp_path: Path) -> None:
    """`python tests/studies/collect/killing.py 200` does it two hundred times."""
    count = survive(8, tmp_path, seed=1)
    assert count.kills["supervisor"] > 0 and count.kills["worker"] > 0
