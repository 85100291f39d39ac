"""Measures what knowing the physics is worth: the same seeds with the label, and with a belief.

    python scripts/knowing.py suite [--episodes 200]
    python scripts/knowing.py fifty [--episodes 20]

Both write docs/results/knowing_SUITE.json. In each task it holds a string for each policy: a digit
an instance of the certified list, 1 where it was solved; of the fifty also 1 where the episode
ended in another state than with the label. The same command goes on where it stopped, in
build/knowing. The physical suite is run under `clean`, RoboTwin's fifty tasks under `phys_random`;
of these, an attribute that a task's script never asks for is not run: a belief about it moves
nothing.
"""

from collections.abc import Callable, Mapping, Sequence
from enum import StrEnum
from pathlib import Path
from typing import Annotated

import typer

import results
from rtphys.assets.pack import default_pack
from rtphys.core import library
from rtphys.episode.policy_episode import begin
from rtphys.expert.robot import ExpertRobot
from rtphys.physics.attribute import is_attribute
from rtphys.physics.reach import split
from rtphys.physics.values import Physics, Value
from rtphys.results import read_results
from rtphys.results.evaluation import EpisodeRecord, EvaluationSpec, short_name
from rtphys.results.instances import benchmark_file, read_list
from rtphys.spec.collection import DATASET_VERSION
from rtphys.spec.episode import EpisodeSpec
from rtphys.studies.evaluate import evaluate
from rtphys.studies.requests import EvaluationRun
from rtphys.task.spec import load_task, task_names

KNOWS, BLIND = "expert", "expert:shuffled"
SENSELESS, FEW = ("idle", "random", "jitter"), 50  # baselines; of how many episodes each
PROTOCOLS = {"suite": "clean", "fifty": "phys_random"}
WORK = Path("build/knowing")
Solved = dict[str, dict[str, str]]  # by policy and task
Records = Mapping[str, Sequence[EpisodeRecord]]  # by task


class Which(StrEnum):
    SUITE = "suite"
    FIFTY = "fifty"


class Asked(Physics):
    """Physics that remembers which attributes somebody has asked for."""

    __slots__ = ("attributes",)

    def __init__(self, physics: Physics) -> None:
        super().__init__(dict(physics), physics.varied)
        self.attributes = set[str]()

    def __getitem__(self, key: str) -> Value:
        self.attributes.add(split(key)[0])
        return super().__getitem__(key)


def main(
    which: Which, episodes: Annotated[int | None, typer.Option(help="Of each task.")] = None
) -> None:
    protocol, name = PROTOCOLS[which], f"knowing_{which}"
    solved: Solved = {}
    if which == Which.SUITE:
        for policy in (KNOWS, BLIND, "feels", *SENSELESS):
            count = FEW if policy in SENSELESS else episodes or 200
            records = played(policy, library.suites()["physics"], protocol, count)
            solved[policy] = digits(records, lambda one: one.success)
            results.save(name, {"dataset_version": DATASET_VERSION, "solved": solved})
        return
    asked = {task: asked_for(task, protocol) for task in task_names()}
    keys = sorted(set[str]().union(*asked.values()))
    moved: Solved = {}
    known: set[str] = set()  # states at the end of episodes with the label
    for key in ("", *keys):
        policy = f"{KNOWS}:{key}=shuffled" if key else KNOWS
        tasks = [task for task, own in asked.items() if (key in own if key else own)]
        records = played(policy, tasks, protocol, episodes or 20)
        solved[policy] = digits(records, lambda one: one.success)
        if key:
            moved[policy] = digits(records, lambda one: one.state not in known)
        else:
            known.update(one.state for of in records.values() for one in of)
        shown = {task: sorted(own) for task, own in asked.items()}
        found = {"asked": shown, "solved": solved, "moved": moved}
        results.save(name, {"dataset_version": DATASET_VERSION, **found})


def digits(records: Records, is_so: Callable[[EpisodeRecord], bool]) -> dict[str, str]:
    """Task -> a digit an instance, 1 where it is so."""
    return {task: "".join(str(int(is_so(one))) for one in of) for task, of in records.items()}


def played(policy: str, tasks: list[str], protocol: str, episodes: int) -> Records:
    """Task -> the records of its instances, in the order of the certified list."""
    out = WORK / short_name(policy.replace("=", "_").replace(":", "_"))
    run = EvaluationRun(tuple(tasks), (protocol,), episodes=episodes, out=out)
    summary = evaluate(EvaluationSpec(policy), run, default_pack())
    typer.echo(f"{policy}, {protocol}: {summary}"[:200])
    records = read_results(out).records
    return {task: records[protocol, task] for task in tasks}


def asked_for(task: str, protocol: str) -> set[str]:
    """Attributes that a task's script asks for on two instances, or the hands that it moves."""
    listed, found = read_list(benchmark_file(protocol, task), task), set[str]()
    assert listed is not None
    for one in listed.feasible[:2]:
        recipe = EpisodeSpec(task, protocol, split="unseen").at(one.seed)
        episode = begin(recipe, load_task(task), default_pack())
        asked = Asked(episode.instance.physics)
        robot = ExpertRobot(episode.rollout, recipe.stream("expert"), belief=asked)
        asked.attributes.clear()
        episode.instance.task.script(robot)
        found |= {key for key in asked.attributes if is_attribute(key)}
    return found


if __name__ == "__main__":
    typer.run(main)
