"""The supervisor: every instance once, records in order, a summary at the end."""

from collections.abc import Callable, Mapping
from pathlib import Path
from typing import NamedTuple

from rtphys.assets.pack import Pack
from rtphys.campaign.workers.local import Crew
from rtphys.campaign.workers.pool import Lost
from rtphys.core.errors import RtphysError
from rtphys.data import files
from rtphys.data.conditions import differences
from rtphys.data.episode import JSON
from rtphys.data.json_text import parse_mapping, pretty
from rtphys.data.lock import FolderLock
from rtphys.episode.fingerprint import fingerprint_of
from rtphys.report.figures.breaks import draw_breaks
from rtphys.results import EpisodeRecord, summarise
from rtphys.results.folder import INSTANCES, RUN, SUMMARY, record_file, short_name, video_file
from rtphys.results.instance_file import instance_file, write_instances
from rtphys.results.official import result_file, write_result
from rtphys.results.record_file import RecordFile
from rtphys.results.summary import Summary
from rtphys.setting.recipe import Recipe
from rtphys.studies.evaluate.lists import certified
from rtphys.studies.evaluate.plan import EvaluatePlan
from rtphys.studies.evaluate.table import Table
from rtphys.studies.evaluate.work import Job, Stage, lost
from rtphys.task.spec import Task

Tables = dict[tuple[str, str], Table]  # by (protocol, task)
Told = Callable[[list[Table]], None]


class OtherRun(RtphysError):
    """The folder holds results of another evaluation."""

    def __init__(self, out: Path, found: list[str]) -> None:
        super().__init__(
            f"{out}: holds results of another evaluation: {'; '.join(found)}. "
            "Choose another --out, or ask for the same again"
        )


class Name(NamedTuple):
    """An episode."""

    protocol: str
    task: str
    seed: int

    def __str__(self) -> str:
        return f"{self.task}, {self.protocol}, seed {self.seed}"


def evaluate(plan: EvaluatePlan, pack: Pack, told: Told = lambda _: None) -> Summary:
    """Runs a policy on its instances and returns the summary, which is also written.

    Records and summary depend on the plan and the policy alone, not on the number of workers, nor
    on how often the run was killed and resumed.

    Args:
        told: called with all tables whenever one has changed.

    Raises:
        RtphysError: what `EvaluatePlan.check` and `certified` refuse; results of another
            evaluation in the folder; a policy that cannot be reached; an exception in a worker.
    """
    tasks = plan.check()
    lists = {
        (protocol, name): certified(plan, name, protocol, fingerprint_of(task, protocol, pack))
        for protocol in plan.protocols
        for name, task in tasks.items()
    }
    files.make_folder(plan.out)
    lock = FolderLock(plan.out)
    try:
        _claim(plan, tasks, pack)
        tables: Tables = {}
        for (protocol, name), instances in lists.items():
            write_instances(instance_file(plan.out / INSTANCES, protocol, name), instances)
            file = RecordFile(record_file(plan.out, protocol, name))
            tables[protocol, name] = Table(name, protocol, instances, file)
        told([*tables.values()])
        with Crew[Job, EpisodeRecord](Stage(pack, plan.policy), plan.workers, plan.limits) as crew:
            _supervise(plan, tables, crew, told)
        return _conclude(plan, tables)
    finally:
        lock.release()


def _claim(plan: EvaluatePlan, tasks: Mapping[str, Task], pack: Pack) -> None:
    """What makes two runs continue each other."""
    run: dict[str, JSON] = {
        "policy": plan.policy,
        "options": dict(plan.options),
        "seed": plan.seed,
        "split": plan.split,
        "episodes": plan.episodes,
        "protocols": list(plan.protocols),
        "tasks": list(plan.tasks),
        "ground": {
            protocol: {
                name: fingerprint_of(task, protocol, pack).to_json() for name, task in tasks.items()
            }
            for protocol in plan.protocols
        },
    }
    path = plan.out / RUN
    if path.exists():
        if not plan.resume:
            raise OtherRun(plan.out, ["and --no-resume asks for a fresh start"])
        before = {**parse_mapping(files.read(path), path), "episodes": plan.episodes}
        if found := differences(before, run):
            raise OtherRun(plan.out, found)
    files.replace_file(path, pretty(run))


def _supervise(
    plan: EvaluatePlan, tables: Tables, crew: Crew[Job, EpisodeRecord], told: Told
) -> None:
    everyone = [*tables.values()]
    waiting = [Name(t.protocol, t.task, seed) for t in everyone for seed in t.todo]
    waiting.reverse()
    while waiting or crew.busy:
        while waiting and crew.room:
            name = waiting.pop()
            crew.submit(name, _job(plan, name))
        for event in crew.wait():
            name = event.name
            assert isinstance(name, Name)
            if isinstance(event, Lost):
                record = lost(_job(plan, name).recipe, event.reason, event.detail)
            else:
                record = event.result
            tables[name.protocol, name.task].take(record)
            told(everyone)


def _job(plan: EvaluatePlan, name: Name) -> Job:
    video = video_file(plan.out, *name) if plan.video else None
    recipe = Recipe(name.task, name.seed, name.protocol, split=plan.split)
    return Job(recipe, plan.setup(name.task, name.protocol), video)


def _conclude(plan: EvaluatePlan, tables: Tables) -> Summary:
    records = {key: table.records for key, table in tables.items()}
    lists = {key: table.instances for key, table in tables.items()}
    summary, policy = summarise(records, lists), short_name(plan.policy)
    text = {"policy": plan.policy, "split": plan.split, **summary.to_json()}
    files.replace_file(plan.out / SUMMARY, pretty(text))
    for protocol, found in summary.breaks.items():
        if found:
            place = plan.out / f"attributes_{protocol}.png"
            draw_breaks(found, f"{policy} under {protocol}", place)
    for row in summary.tasks:
        counts = row.counts
        path = result_file(plan.out, row.task, policy, row.protocol)
        write_result(path, plan.split, (counts.rollouts, counts.slots, counts.successes))
    return summary
