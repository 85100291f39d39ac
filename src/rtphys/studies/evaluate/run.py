"""`evaluate`: every certified instance once, records in their order, a summary at the end."""

import time
from collections.abc import Mapping, Sequence
from pathlib import Path

from rtphys.assets.pack import Pack
from rtphys.campaign.engine import Listener, run_all
from rtphys.campaign.row_journal import RowJournal
from rtphys.campaign.series import Series, Study, Tally
from rtphys.campaign.workers.local import LocalPool, cores
from rtphys.campaign.workers.pool import Lost
from rtphys.core.errors import BadFile, RtphysError
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
from rtphys.results.instances import InstanceList
from rtphys.results.official import result_file, write_result
from rtphys.results.record_file import read_records, write_records
from rtphys.results.summary import Summary
from rtphys.setting.setting import Setting
from rtphys.studies.evaluate.lists import certified
from rtphys.studies.evaluate.plan import EvaluatePlan
from rtphys.studies.evaluate.work import EvaluateWorker, Job, lost_record
from rtphys.task.spec import Task

WRITE_SECONDS = 10.0  # [s] between two writings of the records of a task


class OtherRun(RtphysError):
    """The folder holds results of another evaluation."""

    def __init__(self, out: Path, clauses: list[str]) -> None:
        super().__init__(
            f"{out}: holds results of another evaluation: {'; '.join(clauses)}. "
            "Choose another folder, or ask for the same again"
        )


class TaskEvaluation(Study[Job, EpisodeRecord]):
    """One task under one protocol: its instances in order, and their records.

    A journal takes each record; the file that people read follows every few seconds.
    """

    def __init__(self, plan: EvaluatePlan, setting: Setting, instances: InstanceList) -> None:
        self.plan, self.setting, self.instances = plan, setting, instances
        self.path = record_file(plan.folder, setting.protocol, setting.task)
        there = read_records(self.path) if self.path.exists() else []
        self._journal = RowJournal(self.path, {"records": len(there)})
        older = self._journal.stored["records"]  # that stood in the file when the journal began
        assert isinstance(older, int)
        where = self._journal.path
        newer = [EpisodeRecord.from_json(row, where) for row in self._journal.rows]
        self._all = [*there[:older], *newer] if newer else there
        self._written_at = time.monotonic()
        seeds = [slot.seed for slot in instances.feasible]
        known = [record.seed for record in self._all]
        # A longer run may stand there: more episodes were asked for once.
        if known[: len(seeds)] != seeds[: len(known)]:
            raise BadFile(self.path, "its seeds are not those of the instance list")
        done = min(len(known), len(seeds))
        tally = Tally(f"{setting.task}, {setting.protocol}", len(seeds), done, done)
        self.series = Series(self, tally, seeds[done:])

    @property
    def records(self) -> Sequence[EpisodeRecord]:
        """Those of the episodes asked for."""
        return self._all[: self.series.tally.wanted]

    def job(self, seed: int) -> Job:
        plan, setting = self.plan, self.setting
        where = (plan.folder, setting.protocol, setting.task, seed)
        return Job(
            setting.at(seed), plan.setup(setting), video_file(*where) if plan.video else None
        )

    def reason(self, result: EpisodeRecord) -> str:
        return ""  # a failure is a result too

    def commit(self, seed: int, result: EpisodeRecord) -> str:
        self._journal.append(result.to_json())
        self._all.append(result)
        if time.monotonic() - self._written_at > WRITE_SECONDS:
            self.write()
        return ""

    def lost(self, seed: int, loss: Lost) -> EpisodeRecord:
        return lost_record(self.setting.at(seed), loss.reason, loss.detail)

    def write(self) -> None:
        """Brings the file that people read up to date. Raises `CannotWrite`."""
        if self._all:  # an interrupted run leaves no empty files of what it never came to
            write_records(self.path, self._all)
        self._written_at = time.monotonic()

    def close(self) -> None:
        self.write()
        self._journal.drop()


def evaluate(plan: EvaluatePlan, pack: Pack, listener: Listener | None = None) -> Summary:
    """Runs a policy on its instances and returns the summary, which is also written.

    Records and summary depend on the plan and the policy alone, not on the number of workers, nor
    on how often the run was killed and resumed.

    Raises:
        RtphysError: what `EvaluatePlan.check` and `certified` refuse; results of another
            evaluation in the folder; a policy that cannot be reached; an error in a worker.
    """
    tasks, listener = plan.check(), listener or Listener()
    cells = [(task, protocol) for protocol in plan.protocols for task in tasks]
    lists = [certified(plan, task, name, fingerprint_of(task, name, pack)) for task, name in cells]
    files.make_folder(plan.folder)
    with FolderLock(plan.folder):
        _claim(plan, tasks, pack)
        studies: list[TaskEvaluation] = []
        for instances in lists:
            copy = instance_file(plan.folder / INSTANCES, instances.protocol, instances.task)
            write_instances(copy, instances)
            setting = plan.setting(instances.task, instances.protocol)
            studies.append(TaskEvaluation(plan, setting, instances))
        worker = EvaluateWorker(pack, plan.policy)
        size = cores() if plan.workers is None else plan.workers
        try:
            with LocalPool[Job, EpisodeRecord](worker, size, plan.limits, listener.noticed) as pool:
                run_all([study.series for study in studies], pool, listener, plan.folder)
        finally:
            for study in studies:
                study.write()
        return _conclude(plan, studies)


def _claim(plan: EvaluatePlan, tasks: Sequence[Task], pack: Pack) -> None:
    """Writes down what makes two runs continue each other, or compares it."""
    fingerprints: dict[str, JSON] = {
        protocol: {task.name: fingerprint_of(task, protocol, pack).to_json() for task in tasks}
        for protocol in plan.protocols
    }
    run: dict[str, JSON] = {
        "policy": plan.policy,
        "options": dict(plan.options),
        "seed": plan.seed,
        "split": plan.split,
        "episodes": plan.episodes,
        "protocols": list(plan.protocols),
        "tasks": list(plan.tasks),
        "ground": fingerprints,
    }
    path = plan.folder / RUN
    if path.exists():
        if not plan.resume:
            raise OtherRun(plan.folder, ["and `resume` is off"])
        before = {**parse_mapping(files.read(path), path), "episodes": plan.episodes}
        if clauses := differences(before, run):
            raise OtherRun(plan.folder, clauses)
    files.replace_file(path, pretty(run))


def _conclude(plan: EvaluatePlan, studies: Sequence[TaskEvaluation]) -> Summary:
    cells = {(study.setting.protocol, study.setting.task): study for study in studies}
    records: Mapping[tuple[str, str], Sequence[EpisodeRecord]] = {
        key: study.records for key, study in cells.items()
    }
    summary = summarise(records, {key: study.instances for key, study in cells.items()})
    policy = short_name(plan.policy)
    text = {"policy": plan.policy, "split": plan.split, **summary.to_json()}
    files.replace_file(plan.folder / SUMMARY, pretty(text))
    for protocol, found in summary.breaks.items():
        if found:
            place = plan.folder / f"attributes_{protocol}.png"
            draw_breaks(found, f"{policy} under {protocol}", place)
    for row in summary.tasks:
        counts = row.counts
        path = result_file(plan.folder, row.task, policy, row.protocol)
        write_result(path, plan.split, (counts.rollouts, counts.slots, counts.successes))
    return summary
