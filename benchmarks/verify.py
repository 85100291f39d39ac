"""Speed of `verify --quick` in MB per CPU-second of one core.

    python benchmarks/verify.py [DATASET]

`checking` checks a whole dataset in a process that runs already, which is the cost of a large one.
`command` is the command from the start of Python to its exit, with its imports. Without a dataset,
typical episodes are collected. No round uses results of an earlier one.
"""

import math
import os
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import rtphys.core.pinned  # noqa: F401  # isort: skip  (before numpy)

from typical import typical

from rtphys.data.check_episode import Effort
from rtphys.data.verify import verify

ROUNDS = 3
COMMAND = "from rtphys.cli.main import app; app()"


def checking(path: Path, effort: Effort) -> float:
    """CPU time of the check in this process [s]."""
    start = time.process_time()
    report = verify(path, effort)
    if not report.sound:
        raise SystemExit(f"{path} is not sound: {report.problems[0]}")
    return time.process_time() - start


def command(path: Path) -> float:
    """CPU time of the command in a process of its own, user and system [s]."""
    before = os.times()
    line = [sys.executable, "-c", COMMAND, "verify", "--quick", "--fresh", str(path)]
    subprocess.run(line, check=True, capture_output=True)
    after = os.times()
    return sum(after[2:4]) - sum(before[2:4])


def main(path: str | None = None) -> None:
    with tempfile.TemporaryDirectory() as folder:
        data = typical(path, folder)
        size = sum(p.stat().st_size for p in data.rglob("*") if p.is_file()) / 1e6
        work = {
            "checking": lambda: checking(data, Effort.QUICK),
            "command": lambda: command(data),
            "decoding every picture": lambda: checking(data, Effort.NORMAL),
        }
        costs = dict.fromkeys(work, math.inf)
        for _ in range(ROUNDS):  # alternating, and the minimum of each: other programs disturb
            costs |= {name: min(costs[name], once()) for name, once in work.items()}
    for name, seconds in costs.items():
        print(f"{name:23} {size / seconds:6.0f} MB per CPU-s ({seconds:.2f} CPU-s, {size:.0f} MB)")


if __name__ == "__main__":
    main(*sys.argv[1:2])
