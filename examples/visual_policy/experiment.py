"""Train and test visuomotor policies: python experiment.py --task click_bell --out run

Collects demonstrations, trains one network on each training set, tests each under every protocol on
certified instances, and writes matrix/<task>.json. Every part resumes: repeat the command. Commands
with different tasks may run beside each other. To choose between options, test on seeds of your
own: --first-seed 2000000 writes matrix.2000000/<task>.json.
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
# Its library brings parts of `phys_random`; the built-in `severity_50` varies looks as well.
RTPHYS = (Path(sys.executable).with_name("rtphys"), "--library", HERE / "library")
POLICY = f"python:{HERE / 'visual_policy.py'}:load"
SIZE = "128x96"  # of every picture; the network needs no larger ones
FIRST_SEED = 1_000_000  # of the demonstrations, far from the certified seeds
CERTIFIED = 100_000  # first seed of the certified lists

# Tests in which nothing else varies: growing ranges of all attributes, and parts of them.
SEVERITIES = ("clean", "phys_random_25", "phys_random_50", "phys_random")
PHYSICS_ALONE = (*SEVERITIES, "phys_random_fixed_height", "phys_random_dynamics")
WITH_LOOKS = ("clean", "phys_random", "official_random", "phys_random_all")


@dataclass(frozen=True)
class TrainingSet:
    """What a network learns from."""

    protocol: str
    tests: tuple[str, ...] = PHYSICS_ALONE  # protocols
    labels: bool = False  # whether it is shown the physics labels
    episodes: int | None = None  # demonstrations; None: `Plan.episodes`


TRAINING = {
    "clean": TrainingSet("clean"),
    "phys_random": TrainingSet("phys_random"),
    "phys_random_labels": TrainingSet("phys_random", labels=True),
    # The first of the same demonstrations.
    "clean_100": TrainingSet("clean", SEVERITIES, episodes=100),
    "phys_random_100": TrainingSet("phys_random", SEVERITIES, episodes=100),
    "phys_random_labels_100": TrainingSet("phys_random", SEVERITIES, labels=True, episodes=100),
    # Looks need many. Another look of an episode costs 85 % of the CPU time of another episode.
    "official_random": TrainingSet("official_random", WITH_LOOKS, episodes=1000),
    "phys_random_all": TrainingSet("phys_random_all", WITH_LOOKS, episodes=1000),
}
Cell = tuple[str, str]  # training set, protocol of the test
Found = dict[str, Any]  # what a test found, as JSON


@dataclass(frozen=True)
class Plan:
    """What one run does for each task."""

    out: Path
    episodes: int = 300  # demonstrations of a training set that does not say
    instances: int = 100  # certified ones of each test
    first_seed: int = CERTIFIED  # of the tests' instances
    steps: int = 5_000
    seed: int = 0
    device: str = "cpu"
    bfloat16: bool = False
    workers: int = 1

    def demonstrations(self, learnt: TrainingSet) -> int:
        """How many a training set has."""
        return learnt.episodes or self.episodes


def run(*words: object) -> None:
    """Run a command; its output is shown. Raises `CalledProcessError`."""
    subprocess.run([str(word) for word in words], check=True)


def demonstrations(plan: Plan, task: str, learnt: TrainingSet) -> Path:
    """Dataset of the demonstrations; what is missing is collected."""
    out = plan.out / "demos" / f"{task}.{learnt.protocol}"
    count = plan.demonstrations(learnt)
    options = ("--episodes", count, "--first-seed", FIRST_SEED, "--size", SIZE, "--no-recovery")
    where = ("--workers", plan.workers, "--out", out)
    run(*RTPHYS, "collect", "--task", task, "--protocol", learnt.protocol, *options, *where)
    return out


def trained(plan: Plan, task: str, name: str) -> Path:
    """Folder of the weights, trained where they are missing."""
    learnt, folder = TRAINING[name], plan.out / "weights" / name
    data = demonstrations(plan, task, learnt)
    flags = [*["--labels"] * learnt.labels, *["--bfloat16"] * plan.bfloat16]
    options = ("--steps", plan.steps, "--seed", plan.seed, "--device", plan.device, *flags)
    where = ("--episodes", plan.demonstrations(learnt), "--out", folder / f"{task}.pt")
    run(sys.executable, HERE / "training.py", data, "--task", task, *options, *where)
    return folder


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


def tested(plan: Plan, task: str, name: str, protocol: str) -> Found:
    """Success of a trained policy, by seed, and what goes with its failures."""
    weights = plan.out / "weights" / name
    out = plan.out / "eval" / str(plan.first_seed) / name / task / protocol
    options = ("--episodes", plan.instances, "--instances", instances(plan, task, protocol))
    given = (
        "--policy-option",
        f"weights={weights}",
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
        "demonstrations": plan.demonstrations(TRAINING[name]),
        "bfloat16": plan.bfloat16,
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
    about = ("instances", "first_seed", "steps", "seed")
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
    parser.add_argument("--train", action="append", choices=TRAINING, help="default: each")
    parser.add_argument("--test", help="protocols; default: those of the training set")
    for name in ("episodes", "instances", "first_seed", "steps", "seed", "workers"):
        parser.add_argument(f"--{name.replace('_', '-')}", type=int, default=getattr(Plan, name))
    parser.add_argument("--device", default=Plan.device)
    parser.add_argument("--bfloat16", action="store_true")
    given = vars(parser.parse_args())
    tasks, training, tests = given.pop("task"), given.pop("train") or TRAINING, given.pop("test")
    plan = Plan(**given)
    own = "" if plan.first_seed == CERTIFIED else f".{plan.first_seed}"
    for task, train in product(tasks, training):
        path = plan.out / f"matrix{own}" / f"{task}.json"
        path.parent.mkdir(parents=True, exist_ok=True)
        trained(plan, task, train)
        for test in tests.split(",") if tests else TRAINING[train].tests:
            found = tested(plan, task, train, test)
            cells = known(path) | {(train, test): found}  # another command may have added some
            path.write_text(json.dumps(matrix(plan, cells), indent=1) + "\n")


if __name__ == "__main__":
    main()
