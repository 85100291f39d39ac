"""Train and test policies with eyes: python experiment.py --task click_bell --out run

Collects demonstrations, trains one network on each training set, tests each under every protocol on
certified instances, and writes matrix.json. Every part resumes: repeat the command.
"""

import argparse
import json
import subprocess
import sys
from collections.abc import Mapping
from dataclasses import dataclass
from itertools import product
from pathlib import Path

from rtphys.results import read_results
from rtphys.results.statistics import Rate, paired

HERE = Path(__file__).resolve().parent
SHIPPED = HERE.parents[1] / "manifests" / "benchmark_v2"
RTPHYS = Path(sys.executable).with_name("rtphys")
POLICY = f"python:{HERE / 'visual_policy.py'}:load"
SIZE = "128x96"  # of every picture; the network needs no larger ones
FIRST_SEED = 1_000_000  # of the demonstrations, far from the certified seeds


@dataclass(frozen=True)
class TrainingSet:
    """What a network learns from."""

    protocol: str
    labels: bool = False  # whether it is shown the physics labels
    looks: int = 1  # textures and lights in which each demonstration is drawn


TRAINING = {
    "clean": TrainingSet("clean"),
    "phys_random": TrainingSet("phys_random"),
    "phys_random_labels": TrainingSet("phys_random", labels=True),
    "official_random": TrainingSet("official_random", looks=10),
    "phys_random_all": TrainingSet("phys_random_all", looks=10),
}
Cell = tuple[str, str, str]  # task, training set, protocol of the test


@dataclass(frozen=True)
class Plan:
    """What one run does for each task."""

    out: Path
    tests: tuple[str, ...] = ("clean", "phys_random")
    episodes: int = 100  # demonstrations of each training set
    instances: int = 24  # certified ones of each test
    steps: int = 2400
    seed: int = 0
    device: str = "cpu"
    bfloat16: bool = False
    workers: int = 1


def run(*words: object) -> None:
    """Run a command; its output is shown. Raises `CalledProcessError`."""
    subprocess.run([str(word) for word in words], check=True)


def demonstrations(plan: Plan, task: str, learnt: TrainingSet) -> list[Path]:
    """Folders of the demonstrations, one for each look; what is missing is collected and drawn."""
    out = plan.out / "demos" / f"{task}.{learnt.protocol}"
    options = ("--episodes", plan.episodes, "--seed", FIRST_SEED, "--size", SIZE, "--no-recovery")
    where = ("--workers", plan.workers, "--out", out)
    states = ("--sense", "states") if learnt.looks > 1 else ()  # to draw from
    run(RTPHYS, "collect", "--task", task, "--protocol", learnt.protocol, *options, *states, *where)
    folders = [out]
    for number in range(1, learnt.looks):
        look = f"{learnt.protocol}.{number}"
        folders.append(plan.out / "demos" / f"{task}.{look}")
        where = ("--workers", plan.workers, "--out", folders[-1])
        run(RTPHYS, "render", out, "--look", look, *where)
    return folders


def trained(plan: Plan, task: str, name: str) -> Path:
    """Folder of the weights, trained where they are missing."""
    learnt, folder = TRAINING[name], plan.out / "weights" / name
    data = demonstrations(plan, task, learnt)
    flags = [*["--labels"] * learnt.labels, *["--bfloat16"] * plan.bfloat16]
    options = ("--steps", plan.steps, "--seed", plan.seed, "--device", plan.device, *flags)
    where = ("--out", folder / f"{task}.pt")
    run(sys.executable, HERE / "training.py", *data, "--task", task, *options, *where)
    return folder


def instances(plan: Plan, task: str, protocol: str) -> Path:
    """Folder of the certified lists: those of rtphys, or lists of one's own for other protocols."""
    if (SHIPPED / protocol / f"{task}.yaml").is_file():
        return SHIPPED
    out = plan.out / "lists"
    options = ("--feasible", plan.instances, "--workers", plan.workers, "--out", out)
    run(RTPHYS, "certify", "--task", task, "--protocol", protocol, *options)
    return out


def tested(plan: Plan, task: str, name: str, protocol: str) -> dict[int, bool]:
    """Success by seed of a trained policy."""
    weights = plan.out / "weights" / name
    out = plan.out / "eval" / weights.name / task / protocol
    options = ("--episodes", plan.instances, "--instances", instances(plan, task, protocol))
    given = ("--set", f"weights={weights}", "--set", f"device={plan.device}", "--size", SIZE)
    what = ("--task", task, "--protocol", protocol, "--workers", plan.workers, "--out", out)
    run(RTPHYS, "evaluate", "--policy", POLICY, *what, *options, *given)
    return {r.seed: r.success for r in read_results(out).records[protocol, task]}


def matrix(plan: Plan, cells: Mapping[Cell, Mapping[int, bool]]) -> dict[str, object]:
    """Rates of the cells so far, and tests between them on the seeds that they share, as JSON."""
    rates = [
        {
            **dict(zip(("task", "train", "test"), cell, strict=True)),
            **Rate(sum(found.values()), len(found)).to_json(),
            "solved": [seed for seed, success in found.items() if success],
            "failed": [seed for seed, success in found.items() if not success],
        }
        for cell, found in cells.items()
    ]
    # What a test's protocol costs a policy, and what its demonstrations are worth under a test.
    pairs = [
        compared(cells, other, (task, train, test))
        for task, train, test in cells
        for other in ((task, train, "clean"), (task, "clean", test))
        if other in cells and other != (task, train, test)
    ]
    about = ("episodes", "instances", "steps", "seed", "bfloat16")
    return {**{key: getattr(plan, key) for key in about}, "cells": rates, "pairs": pairs}


def known(path: Path) -> dict[Cell, dict[int, bool]]:
    """Cells of a matrix that earlier runs wrote; none without one."""
    cells: dict[Cell, dict[int, bool]] = {}
    for cell in json.loads(path.read_text())["cells"] if path.exists() else ():
        found = dict.fromkeys(cell["solved"], True) | dict.fromkeys(cell["failed"], False)
        cells[cell["task"], cell["train"], cell["test"]] = dict(sorted(found.items()))
    return cells


def compared(
    cells: Mapping[Cell, Mapping[int, bool]], first: Cell, second: Cell
) -> dict[str, object]:
    """McNemar's test of two cells on the seeds that they share."""
    common = sorted(cells[first].keys() & cells[second].keys())
    found = paired([(cells[first][seed], cells[second][seed]) for seed in common])
    return {"first": [*first], "second": [*second], **found.to_json()}


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--task", action="append", required=True, help="repeatable")
    parser.add_argument("--out", type=Path, required=True)
    parser.add_argument("--train", action="append", choices=TRAINING, help="default: each")
    parser.add_argument("--test", default=",".join(Plan.tests), help="protocols")
    for name in ("episodes", "instances", "steps", "seed", "workers"):
        parser.add_argument(f"--{name}", type=int, default=getattr(Plan, name))
    parser.add_argument("--device", default=Plan.device)
    parser.add_argument("--bfloat16", action="store_true")
    given = vars(parser.parse_args())
    tasks, training = given.pop("task"), given.pop("train") or TRAINING
    plan = Plan(tests=tuple(given.pop("test").split(",")), **given)
    path = plan.out / "matrix.json"
    cells = known(path)
    for train, task in product(training, tasks):
        trained(plan, task, train)
        for test in plan.tests:
            cells[task, train, test] = tested(plan, task, train, test)
            path.write_text(json.dumps(matrix(plan, cells), indent=1) + "\n")


if __name__ == "__main__":
    main()
