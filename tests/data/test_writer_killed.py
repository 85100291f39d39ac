"""kill -9 at any instant: the folder is a valid prefix, and resuming gives the same bytes."""

import os
import signal
import sys
import time
from pathlib import Path
from types import FrameType

import pytest
import synthetic
from collected import content, outcome, wanting

from rtphys import data
from rtphys.core.seeds import stream
from rtphys.data.layout import MANIFEST
from rtphys.data.verify import verify
from rtphys.data.writer import DatasetWriter

EPISODES = 4


def attempt_all(out: Path) -> None:
    """Into a folder `kept` with its failures, into any other without."""
    kept = "all" if "kept" in out.parts else None
    with DatasetWriter(out) as dataset:
        task = dataset.task(wanting(EPISODES, synthetic.header(keep_failures=kept)))
        while not task.done:
            task.record(outcome(task, task.next_seed))
            dataset.checkpoint()


def run_child(out: Path, seconds: float | None, line: int = 0) -> bool:
    """Collects in a child; True when it had finished.

    Args:
        seconds: it is killed after this time.
        line: it is killed before this line of all that its commits execute, counted from 1.
    """
    child = os.fork()
    if child == 0:
        code = 1
        try:
            sys.settrace(Commits(line).enter if line else None)
            attempt_all(out)
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
    rng = stream(kills, "kill", *out.parts[-2:])  # other instants in each trial
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


class Commits:
    """Counts the lines of `rtphys.data` that are executed while an outcome is committed."""

    PLACE = str(Path(data.__file__).parent)

    def __init__(self, last: int) -> None:
        self.last, self.count, self.inside = last, 0, False

    def enter(self, frame: FrameType, event: str, _: object):
        code = frame.f_code
        if not code.co_filename.startswith(self.PLACE):
            return None
        if code.co_name in ("record", "checkpoint"):
            self.inside = True
        return self.step if self.inside else None

    def step(self, frame: FrameType, event: str, _: object):
        if event == "line":
            self.count += 1
            if self.count == self.last:
                os.kill(os.getpid(), signal.SIGKILL)
        elif event == "return" and frame.f_code.co_name in ("record", "checkpoint"):
            self.inside = False
        return self.step


def lines_of_all_commits(out: Path) -> int:
    """In a run that nobody kills, of this process."""
    commits = Commits(-1)
    before = sys.gettrace()
    sys.settrace(commits.enter)
    try:
        attempt_all(out)
    finally:
        sys.settrace(before)
    return commits.count


@pytest.fixture(scope="module", params=["plain", "kept"])
def undisturbed(
    request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory
) -> tuple[str, dict[str, bytes], float]:
    """Name of the kind, what an undisturbed run leaves, and how long it takes [s]."""
    out = tmp_path_factory.mktemp("undisturbed") / request.param
    start = time.monotonic()
    assert run_child(out, None)
    duration, expected = time.monotonic() - start, content(out)
    failures = sum("/failures/data/" in name for name in expected)
    assert failures == (request.param == "kept")
    return request.param, expected, duration


@pytest.mark.parametrize("kills", [4, pytest.param(200, marks=pytest.mark.slow)])
def test_a_kill_inside_a_commit_loses_nothing(
    tmp_path: Path, undisturbed: tuple[str, dict[str, bytes], float], kills: int
) -> None:
    kind, expected, _ = undisturbed
    lines = lines_of_all_commits(tmp_path / "counted" / kind)
    assert content(tmp_path / "counted" / kind) == expected
    instants = stream(kills, "kills inside commits").choice(lines, kills, replace=False) + 1
    for number, line in enumerate(sorted(instants.tolist())):
        out = tmp_path / str(number) / kind
        assert not run_child(out, None, line), f"line {line} of {lines} was never reached"
        if (out / MANIFEST).exists():
            assert verify(out).problems == [], f"killed before line {line} of {lines}"
        assert run_child(out, None)
        assert content(out) == expected, f"killed before line {line} of {lines}"


@pytest.mark.parametrize("kills", [5, pytest.param(200, marks=pytest.mark.slow)])
def test_killed_runs_end_in_the_same_dataset(
    tmp_path: Path, undisturbed: tuple[str, dict[str, bytes], float], kills: int
) -> None:
    kind, expected, duration = undisturbed
    hits, trial = 0, 0
    while hits < kills:
        out = tmp_path / str(trial) / kind
        hits += kill_until_done(out, kills - hits, duration)
        assert content(out) == expected
        assert not (out / ".rtphys.lock").exists()
        trial += 1
