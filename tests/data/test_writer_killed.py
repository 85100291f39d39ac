"""kill -9 at random instants: the folder is a valid prefix, and resuming gives the same bytes."""

import os
import signal
import time
from pathlib import Path

import pytest
import synthetic
from test_dataset_writer import collect, content

from rtphys.core.seeds import stream
from rtphys.data.layout import MANIFEST
from rtphys.data.verify import verify
from rtphys.data.writer import DatasetWriter

EPISODES = 4


def run_child(out: Path, seconds: float | None) -> bool:
    """Collects in a child that is killed after some time; True when it had finished."""
    child = os.fork()
    if child == 0:
        code = 1
        try:
            DatasetWriter.checkpoint_if_due = DatasetWriter.checkpoint  # manifest at every attempt
            with DatasetWriter(out) as dataset:
                task = dataset.task(synthetic.conditions(), EPISODES)
                from test_dataset_writer import outcome

                while not task.done:
                    task.record(outcome(task, task.next_seed))
                    dataset.checkpoint_if_due()
            code = 0
        finally:
            os._exit(code)
    if seconds is not None:
        time.sleep(seconds)
        os.kill(child, signal.SIGKILL)
    _, status = os.waitpid(child, 0)
    return status == 0


def kill_until_done(out: Path, kills: int, longest: float) -> int:
    """Kills again and again on the way; returns how often a run really was cut off."""
    rng = stream(kills, "kill", out.name)
    hits = 0
    for _ in range(kills):
        finished = run_child(out, rng.uniform(0, longest))
        hits += not finished
        if (out / MANIFEST).exists():
            assert verify(out).problems == []
        if finished:
            break
    assert run_child(out, None)
    return hits


@pytest.fixture(scope="module")
def reference(tmp_path_factory: pytest.TempPathFactory) -> tuple[dict[str, bytes], float]:
    out = tmp_path_factory.mktemp("reference")
    collect(out, EPISODES)
    start = time.monotonic()
    assert run_child(tmp_path_factory.mktemp("timed"), None)
    return content(out), time.monotonic() - start


@pytest.mark.parametrize("kills", [5, 5, pytest.param(200, marks=pytest.mark.slow)])
def test_killed_runs_end_in_the_same_dataset(
    tmp_path: Path, reference: tuple[dict[str, bytes], float], kills: int
) -> None:
    expected, duration = reference
    hits, trial = 0, 0
    while hits < kills:
        out = tmp_path / str(trial)
        hits += kill_until_done(out, kills - hits, duration)
        assert content(out) == expected
        assert not (out / ".rtphys.lock").exists()
        trial += 1
