"""Kills collections with SIGKILL at random instants, resumes them, and compares what comes out.

    python tests/studies/collect/killing.py [KILLS [SHARE]]      about 5 CPU-seconds a kill

A run is killed again and again until it is complete, half of the time in a worker (SHARE; 1:
workers alone); so a handful of kills costs one dataset.
"""

import os
import signal
import subprocess
import sys
import tempfile
import time
from collections import Counter
from dataclasses import dataclass, field
from pathlib import Path

import rtphys.core.pinned  # noqa: F401  # isort: skip  (before numpy)

import numpy as np
from collecting import content, worker_processes

from rtphys.core.seeds import stream
from rtphys.data.layout import MANIFEST
from rtphys.data.verify import verify

EPISODES = 3
LONGEST = 0.9  # until the next kill, in units of an undisturbed run
BUSY = 1.5  # [s] until the next kill of a worker, from when there is one
PATIENCE = 600  # [s] a run that nobody kills may take: longer is a hang
IN_A_ROW = 4  # kills of workers in one life: a job may lose five workers to others
DEATH = 10.0  # [s] within which the workers of a dead supervisor must be gone


class Damage(AssertionError):
    """A kill that was not survived."""


@dataclass
class Killings:
    """When to kill, and whom; what was done."""

    rng: np.random.Generator
    longest: float  # [s] until the next kill of a supervisor
    share: float  # of the kills that hit a worker, where there is one
    kills: Counter[str] = field(default_factory=Counter)
    datasets: int = 0

    def one_life(self, out: Path, workers: int) -> bool:
        """From start to death; True when the run was complete before."""
        process = subprocess.Popen(
            command(out, workers), stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True
        )
        for _ in range(IN_A_ROW):
            if self.rng.random() >= self.share:
                break
            begun = time.monotonic()
            while not worker_processes(process.pid) and process.poll() is None:
                if time.monotonic() - begun > PATIENCE:
                    raise Damage(f"{out}: no worker begins")
                time.sleep(0.05)
            if ended(process, self.rng.uniform(0, BUSY), out):
                return True
            if alive := worker_processes(process.pid):
                os.kill(alive[int(self.rng.integers(len(alive)))], signal.SIGKILL)
                self.kills["worker"] += 1
        wait = self.rng.uniform(0, self.longest) if self.share < 1 else PATIENCE
        if ended(process, wait, out):
            return True
        alive = worker_processes(process.pid)
        process.kill()
        process.communicate()
        self.kills["supervisor"] += 1
        end = time.monotonic() + DEATH
        while any(map(is_worker, alive)):
            if time.monotonic() > end:
                raise Damage(f"{out}: workers outlive their supervisor")
            time.sleep(0.05)
        return False


def command(out: Path, workers: int) -> list[str]:
    options = f"--task click_bell --protocol phys_random --cameras head --episodes {EPISODES}"
    line = [sys.executable, "-m", "rtphys.cli.main", "collect", *options.split()]
    return [*line, "--workers", str(workers), "--out", str(out)]


def ended(process: subprocess.Popen[str], seconds: float, out: Path) -> bool:
    """Whether a run is complete within some time. Raises `Damage`: it failed."""
    try:
        _, said = process.communicate(timeout=seconds)
    except subprocess.TimeoutExpired:
        return False
    if process.returncode:
        raise Damage(f"{out}: ended with {process.returncode}: {said[-2000:]}")
    return True


def collect(out: Path, workers: int) -> float:
    """Undisturbed; the seconds it took."""
    start = time.monotonic()
    done = subprocess.run(command(out, workers), capture_output=True, text=True, timeout=PATIENCE)
    if done.returncode:
        raise Damage(f"{out}: cannot be resumed: {done.stderr[-2000:]}")
    return time.monotonic() - start


def is_worker(pid: int) -> bool:
    """Whether a process is a worker that still runs."""
    try:
        name, _, state = Path(f"/proc/{pid}/stat").read_text().partition(") ")
    except OSError:
        return False
    return name.endswith("rtphys-worker") and not state.startswith("Z")


def survive(kills: int, folder: Path, seed: int = 0, share: float = 0.5) -> Killings:
    """Datasets by one worker and by two in turn, until so many kills were survived.

    Raises:
        Damage: a dataset that is damaged, cannot be resumed, or differs from the undisturbed one.
    """
    whole = folder / "undisturbed"
    count = Killings(stream(seed, "kill"), LONGEST * collect(whole, 1), share)
    expected = content(whole)
    while count.kills.total() < kills:
        out, workers = folder / str(count.datasets), 1 + count.datasets % 2
        while count.kills.total() < kills:
            complete = count.one_life(out, workers)
            if (out / MANIFEST).exists() and (problems := verify(out).problems):
                raise Damage(f"{out}: after a kill: {problems}")
            if complete:
                break
        else:
            collect(out, workers)
        if (found := content(out)) != expected:
            changed = sorted(set(found.items()) ^ set(expected.items()))
            raise Damage(f"{out}: differs after {dict(count.kills)}: {changed}")
        count.datasets += 1
        print(f"{count.datasets} datasets, {dict(count.kills)}", flush=True)
    return count


if __name__ == "__main__":
    with tempfile.TemporaryDirectory() as place:
        kills, share = [*sys.argv[1:], *("200", "0.5")[len(sys.argv) - 1 :]]
        survive(int(kills), Path(place), share=float(share))
