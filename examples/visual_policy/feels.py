"""What a policy must sense to learn what `feels` does: trained on its episodes, and tested.

    python examples/visual_policy/feels.py --task open_the_loose --task bin_the_slippery --out run

Tasks of the physical suite under `clean`. Each network is trained on the same demonstrations, those
of the policy `feels`, and sees pictures and joint commands alone, or also efforts and touch, or
also remembers these of the last 15 s. It is tested on the first certified instances. Writes
run/learner.json: task -> what it sees -> a digit an instance, 1 where it was solved. The same
command continues where it stopped; commands with different tasks may run beside each other.
"""

import argparse
import json
import sys
from itertools import product
from pathlib import Path
from typing import get_args

from experiment import FIRST_SEED, HERE, POLICY, SIZE, run
from sight import Sees

from rtphys.results import read_results

RTPHYS, CLEAN = Path(sys.executable).with_name("rtphys"), ("--protocol", "clean")
DRAWN = ("--size", SIZE, "--sense", "touch")


def demonstrations(out: Path, task: str, episodes: int, workers: int) -> Path:
    """Dataset of what `feels` does on seeds that are not in the benchmark."""
    lists, data = out / "lists" / task, out / "demos" / task
    seeds = ("--first-seed", FIRST_SEED, "--feasible", episodes, "--replays", "none")
    run(RTPHYS, "certify", task, *CLEAN, *seeds, "--workers", workers, "--out", lists)
    played = ("--instances", lists, "--workers", workers, "--out", out / "feels" / task)
    run(RTPHYS, "evaluate", task, *CLEAN, "--policy", "feels", "--record", data, *DRAWN, *played)
    return data


def solved(out: Path, task: str, sees: str, instances: int, workers: int) -> str:
    """A digit a certified instance, in the order of the list."""
    folder = out / "eval" / sees / task
    weights = f"weights={out / 'weights' / sees / task}.pt"
    where = ("--episodes", instances, "--workers", workers, "--out", folder)
    policy = ("--policy", POLICY, "--policy-option", weights)
    run(RTPHYS, "evaluate", task, *CLEAN, *policy, *DRAWN, *where)
    return "".join(str(int(one.success)) for one in read_results(folder).records["clean", task])


def main() -> None:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--task", action="append", required=True, help="repeatable")
    parser.add_argument("--out", type=Path, required=True)
    parser.add_argument("--episodes", type=int, default=300, help="demonstrations of each task")
    parser.add_argument("--instances", type=int, default=100, help="tests of each network")
    parser.add_argument("--steps", type=int, default=5_000)
    parser.add_argument("--workers", type=int, default=1)
    given = parser.parse_args()
    path = given.out / "learner.json"
    for task, sees in product(given.task, get_args(Sees)):
        data = demonstrations(given.out, task, given.episodes, given.workers)
        weights = given.out / "weights" / sees / f"{task}.pt"
        options = ("--steps", given.steps, "--sees", sees, "--out", weights)
        run(sys.executable, HERE / "training.py", data, "--task", task, *options)
        outcome = solved(given.out, task, sees, given.instances, given.workers)
        found = json.loads(path.read_text()) if path.exists() else {}
        found.setdefault(task, {})[sees] = outcome
        path.write_text(json.dumps(found, indent=1, sort_keys=True) + "\n")


if __name__ == "__main__":
    main()
