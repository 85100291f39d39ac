"""Tries the policies that see nothing on certified instances: none may solve one.

    python scripts/blind.py [--episodes 50] [--policy idle,random,jitter]

docs/results/blind.json holds successes and trials by policy, protocol and task, and is written
after every few tasks. The same command goes on where it stopped, on any machine: what the file has
with as many trials, and was measured on this dataset version, is not tried again.
"""

import tempfile
from dataclasses import replace
from itertools import product
from pathlib import Path
from typing import Annotated

import typer

import results
from rtphys.assets.pack import default_pack
from rtphys.results import read_results
from rtphys.results.evaluation import EvaluationSpec
from rtphys.results.instances import InstanceList, benchmark_file, list_file, read_list, write_lists
from rtphys.spec.collection import DATASET_VERSION
from rtphys.studies.evaluate import evaluate
from rtphys.studies.requests import EvaluationRun
from rtphys.task.spec import task_names

PROTOCOLS = ("clean", "phys_random_all")
BATCH = 5  # tasks between two writes of the file
Trials = dict[str, dict[str, dict[str, list[int]]]]  # policy, protocol, task: successes, trials


def main(
    episodes: Annotated[int, typer.Option(help="Episodes of each task and protocol.")] = 50,
    policy: Annotated[str, typer.Option(help="Policies, with commas.")] = "idle,random,jitter",
) -> None:
    trials = _known()
    for name, protocol in product(policy.split(","), PROTOCOLS):
        there = trials.setdefault(name, {}).setdefault(protocol, {})
        missing = [task for task in task_names() if there.get(task, [0, 0])[1] < episodes]
        for start in range(0, len(missing), BATCH):
            tasks = tuple(missing[start : start + BATCH])
            known = {task: there.get(task, [0, 0])[1] for task in tasks}
            for task, (successes, tried) in _measured(name, protocol, known, episodes).items():
                before = there.get(task, [0, 0])
                there[task] = [before[0] + successes, before[1] + tried]
            results.save("blind", {"dataset_version": DATASET_VERSION, "trials": trials})
            typer.echo(f"{name}, {protocol}: {len(there)} tasks, {_total(there)}")


def _known() -> Trials:
    stored = results.load("blind")
    return stored["trials"] if stored["dataset_version"] == DATASET_VERSION else {}


def _measured(
    policy: str, protocol: str, known: dict[str, int], episodes: int
) -> dict[str, list[int]]:
    """Successes and trials on the instances of each task after the known ones."""
    with tempfile.TemporaryDirectory() as folder:
        lists, out = Path(folder) / "lists", Path(folder) / "records"
        rest = [_rest(protocol, task, slice(tried, episodes)) for task, tried in known.items()]
        write_lists(list_file(lists, protocol), rest)
        tasks = tuple(known)
        run = EvaluationRun(tasks, (protocol,), out=out, instances=lists)
        evaluate(EvaluationSpec(policy), run, default_pack())
        records = read_results(out).records
        return {
            task: [sum(record.success for record in found), len(found)]
            for (_, task), found in records.items()
        }


def _rest(protocol: str, task: str, which: slice) -> InstanceList:
    """A list of only these feasible instances of the certified one."""
    whole = read_list(benchmark_file(protocol, task), task)
    assert whole is not None
    seeds = [one.seed for one in whole.feasible[which]]
    rest = tuple(one for one in whole.instances if seeds[0] <= one.seed <= seeds[-1])
    return replace(whole, instances=rest)


def _total(there: dict[str, list[int]]) -> str:
    successes, tried = (sum(counts) for counts in zip(*there.values(), strict=True))
    return f"{successes} of {tried} episodes solved"


if __name__ == "__main__":
    typer.run(main)
