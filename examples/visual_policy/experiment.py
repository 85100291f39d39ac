"""Train and test visuomotor policies: python experiment.py --task click_bell --out run

Collects demonstrations under two protocols, trains a network on each, tests both under four
protocols on certified instances, and writes matrix/<task>.json. Every part resumes: repeat the
command. Commands with different tasks may run beside each other. To choose between options, test on
seeds of your own: --first-seed 2000000 writes matrix.2000000/<task>.json.
"""

import argparse
import json
import subprocess
import sys
from collections import Counter
from collections.abc import Mapping
from dataclasses import dataclass
from itertools import product
from pathlib import Path
from typing import Any

from rtphys.results import read_results
from rtphys.results.breaks import breaks
from rtphys.results.instances import list_file, read_list

HERE = Path(__file__).resolve().parent
SHIPPED = HERE.parents[1] / "manifests" / "benchmark_v3"
# Its library brings parts of `phys_random`.
RTPHYS = (Path(sys.executable).with_name("rtphys"), "--library", HERE / "library")
POLICY = f"python:{HERE / 'visual_policy.py'}:load"
SIZE = "128x96"  # of every picture; the network needs no larger ones
FIRST_SEED = 1_000_000  # of the demonstrations, far from the certified seeds
CERTIFIED = 100_000  # first seed of the certified lists
TRAINING = ("clean", "phys_random")
TESTS = ("clean", "phys_random", "phys_random_fixed_height", "phys_random_dynamics")

Cell = tuple[str, str]  # protocol of the demonstrations, and of the test
Found = dict[str, Any]  # what a test found, as JSON


@dataclass(frozen=True)
class Plan:
    """What one run does for each task."""

    out: Path
    episodes: int = 300  # demonstrations under each protocol
    instances: int = 100  # certified ones of each test
    first_seed: int = CERTIFIED  # of the tests' instances
    steps: int = 5_000
    seed: int = 0
    device: str = "cpu"
    workers: int = 1


def run(*words: object) -> None:
    """Run a command; its output is shown. Raises `CalledProcessError`."""
    subprocess.run([str(word) for word in words], check=True)


def demonstrations(plan: Plan, task: str, protocol: str) -> Path:
    """Dataset of the demonstrations; what is missing is collected."""
    out = plan.out / "demos" / f"{task}.{protocol}"
    what = ("--task", task, "--protocol", protocol, "--episodes", plan.episodes)
    options = ("--first-seed", FIRST_SEED, "--size", SIZE, "--no-recovery")
    run(*RTPHYS, "collect", *what, *options, "--workers", plan.workers, "--out", out)
    return out


def trained(plan: Plan, task: str, protocol: str) -> None:
    """Train a network on demonstrations of a protocol, where its weights are missing."""
    data = demonstrations(plan, task, protocol)
    options = ("--steps", plan.steps, "--seed", plan.seed, "--device", plan.device)
    where = ("--out", weights(plan.out, task, protocol))
    run(sys.executable, HERE / "training.py", data, "--task", task, *options, *where)


def weights(out: Path, task: str, train: str) -> Path:
    """Checkpoint of a task that was trained under a protocol."""
    return out / "weights" / train / f"{task}.pt"


def instances(plan: Plan, task: str, protocol: str) -> Path:
    """Folder of the certified lists: those of rtphys, or longer ones that are certified here."""
    shipped = list_file(SHIPPED, protocol)
    if plan.first_seed == CERTIFIED and shipped.is_file():
        listed = read_list(shipped, task)
        if listed is not None and len(listed.feasible) >= plan.instances:
            return SHIPPED
    out = plan.out / "lists" / str(plan.first_seed) / task  # certify locks its folder
    what = ("--task", task, "--protocol", protocol, "--first-seed", plan.first_seed)
    options = ("--feasible", plan.instances, "--replays", "none", "--workers", plan.workers)
    run(*RTPHYS, "certify", *what, *options, "--out", out)
    return out


def tested(plan: Plan, task: str, train: str, protocol: str) -> Found:
    """Success of a trained policy, by seed, and what goes with its failures."""
    out = plan.out / "eval" / str(plan.first_seed) / train / task / protocol
    options = ("--episodes", plan.instances, "--instances", instances(plan, task, protocol))
    given = (
        "--policy-option",
        f"weights={weights(plan.out, task, train)}",
        "--policy-option",
        f"device={plan.device}",
        "--size",
        SIZE,
    )
    what = ("--task", task, "--protocol", protocol, "--workers", plan.workers, "--out", out)
    run(*RTPHYS, "evaluate", "--policy", POLICY, *what, *options, *given)
    records = read_results(out).records[protocol, task]
    kept = ("attribute", "low", "high", "log_odds", "p", "p_holm")  # of what each attribute does
    return {
        "solved": [r.seed for r in records if r.success],
        "failed": [r.seed for r in records if not r.success],
        "reasons": dict(Counter(r.reason for r in records if not r.success)),
        "attributes": [{key: _short(b.to_json()[key]) for key in kept} for b in breaks(records)],
    }


def _short(value: Any) -> Any:
    return float(f"{value:.4g}") if isinstance(value, float) else value


def matrix(plan: Plan, cells: Mapping[Cell, Found]) -> dict[str, object]:
    """The cells of a task so far, in whatever order runs have found them, as JSON."""
    found = [{"train": train, "test": test, **of} for (train, test), of in sorted(cells.items())]
    about = ("episodes", "instances", "first_seed", "steps", "seed")
    return {**{key: getattr(plan, key) for key in about}, "cells": found}


def known(path: Path) -> dict[Cell, Found]:
    """Cells of a matrix that earlier runs wrote; none without one."""
    cells = json.loads(path.read_text())["cells"] if path.exists() else ()
    return {(cell.pop("train"), cell.pop("test")): cell for cell in cells}


def main() -> None:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--task", action="append", required=True, help="repeatable")
    parser.add_argument("--out", type=Path, required=True)
    parser.add_argument("--train", help="protocols of demonstrations", default=",".join(TRAINING))
    parser.add_argument("--test", help="protocols of tests", default=",".join(TESTS))
    for name in ("episodes", "instances", "first_seed", "steps", "seed", "workers"):
        parser.add_argument(f"--{name.replace('_', '-')}", type=int, default=getattr(Plan, name))
    parser.add_argument("--device", default=Plan.device)
    given = vars(parser.parse_args())
    tasks, training, tests = given.pop("task"), given.pop("train"), given.pop("test")
    plan = Plan(**given)
    own = "" if plan.first_seed == CERTIFIED else f".{plan.first_seed}"
    for task, train in product(tasks, training.split(",")):
        path = plan.out / f"matrix{own}" / f"{task}.json"
        path.parent.mkdir(parents=True, exist_ok=True)
        trained(plan, task, train)
        for test in tests.split(","):
            found = tested(plan, task, train, test)
            cells = known(path) | {(train, test): found}  # another command may have added some
            path.write_text(json.dumps(matrix(plan, cells), indent=1) + "\n")


if __name__ == "__main__":
    main()
