"""Shards without a robot: an episode is three small files, so that many can be made."""

from dataclasses import replace
from pathlib import Path

from rtphys.core.seeds import stream
from rtphys.data import files
from rtphys.data.conditions import Conditions
from rtphys.data.staging import HDF5, INSTRUCTION, VIDEO
from rtphys.data.task_writer import TaskWriter
from rtphys.data.writer import DatasetWriter, Rejection, StagedEpisode
from rtphys.studies.collect import CollectPlan, Summary, Tally, dealt
from rtphys.studies.collect.run import Known
from rtphys.studies.collect.shard import claim

TASKS = ("click_bell", "lift_pot", "stamp_seal")
EPISODES = 12


def plan(tasks: int = 2, episodes: int = EPISODES) -> CollectPlan:
    return CollectPlan(TASKS[:tasks], episodes, Path("data"), first_seed=3)


def conditions(plan: CollectPlan, task: str) -> Conditions:
    stride = (0, 1) if plan.shard is None else plan.shard.stride
    return Conditions(
        task=task,
        protocol=plan.protocol,
        first_seed=plan.first_seed,
        domain_name="nominal",
        domain_digest="0" * 64,
        domain={},
        cameras=("head_camera",),
        versions={"rtphys": "0.1.0"},
        assets={"digest": "a" * 64},
        config=plan.config,
        stride=stride if stride[1] > 1 else None,
    )


def outcome(task: TaskWriter, seed: int, rate: float) -> StagedEpisode | Rejection:
    chance = stream(seed, task.conditions.task)
    if chance.random() > rate:
        return Rejection(seed, "grip_slip", "need 14 N", {"friction": chance.random()})
    folder = task.staging(seed)
    folder.mkdir(parents=True)
    names = (HDF5, VIDEO, INSTRUCTION)
    facts = {name: files.write_synced(folder / name, chance.bytes(99)) for name in names}
    meta = {"seed": seed, "verdict": {}, "attributes": {"friction": {"value": chance.random()}}}
    return StagedEpisode(seed, folder, 7, facts, meta, {"info": {"{b}": 1, "{a}": "left"}})


def collect(plans: tuple[CollectPlan, ...], out: Path) -> Path:
    """As `collect` does, without a robot."""
    for one in plans:
        work(replace(one, out=out))
    return out


def work(plan: CollectPlan, told: object = None, known: Known | None = None) -> Summary:
    """The same for one plan; a plan that limits its attempts is of a hard task."""
    rate = 0.7 if plan.most_attempts is None else 0.2
    end = plan.first_seed + (plan.most_attempts or 1000)
    sides = (plan, plan.twin_plan) if plan.twin_plan else (plan,)
    tallies = []
    with DatasetWriter(plan.out) as dataset:
        claim(plan.out, plan.shard)
        for name in plan.tasks:
            writers = [dataset.task(conditions(side, name), plan.share) for side in sides]
            before = writers[0].attempts
            while not writers[0].done and (seed := writers[0].next_seed) < end:
                folders = [writer.staging(seed) for writer in writers]
                found = known(name, seed, folders) if known else None
                MADE.extend([] if found else [seed])
                made = found or tuple(outcome(writer, seed, rate) for writer in writers)
                for writer, one in zip(writers, made, strict=True):
                    writer.record(one)
            counts = (writers[0].episodes, writers[0].attempts)
            tallies.append(Tally(name, plan.share, *counts, found_attempts=before))
    return Summary(plan.out, tallies, 0.0)


MADE: list[int] = []
"""Seeds that were tried."""


def shards(whole: CollectPlan, of: int, folder: Path) -> list[Path]:
    texts = [f"{index}/{of}" for index in range(1, of + 1)]
    return [collect(dealt([whole], t), folder / t.replace("/", "-")) for t in texts]
