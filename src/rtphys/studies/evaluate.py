"""`evaluate`: every certified instance once, records in their order, a summary at the end."""

import traceback
from bisect import bisect_left
from collections.abc import Sequence
from contextlib import nullcontext
from dataclasses import dataclass, field
from operator import attrgetter
from pathlib import Path
from typing import NamedTuple

from rtphys.assets.embodiment import DEFAULT
from rtphys.assets.pack import Pack
from rtphys.campaign.local import run_here
from rtphys.campaign.pool import WorkerFailure
from rtphys.campaign.series import QUIET, Listener, Progress, Series
from rtphys.core import library
from rtphys.core.errors import BadFile, BadValue, Infeasible, RtphysError, counted
from rtphys.data import files
from rtphys.data.attempts import Rejected
from rtphys.data.dataset import Dataset
from rtphys.data.faults import DatasetMismatch
from rtphys.data.json_text import plain, pretty, spelled
from rtphys.data.layout import MANIFEST, embodiment_folder
from rtphys.data.ledger import Ledger
from rtphys.data.lock import FolderLock
from rtphys.data.manifest import TaskEntry
from rtphys.data.staging import StagedEpisode
from rtphys.data.writer import DatasetWriter, Rejection, TaskWriter
from rtphys.episode import PolicyEpisode, begin
from rtphys.episode.assemble import rejection
from rtphys.episode.fingerprint import fingerprint_of, packages
from rtphys.episode.generate import Attempt
from rtphys.episode.render import write_video
from rtphys.physics import attributes, could_act
from rtphys.physics.attribute import attribute
from rtphys.plan.kinematics import check_robot
from rtphys.policies import PolicyBroken, PolicyGone, PolicySession, PolicySetup, files_digest
from rtphys.policies.registry import edited
from rtphys.report.figures import draw_breaks
from rtphys.results import evaluation
from rtphys.results.evaluation import EpisodeRecord, EvaluationHeader, EvaluationSpec
from rtphys.results.instances import (
    BenchmarkInstance,
    Fingerprint,
    InstanceList,
    list_file,
    lists_folder,
    read_list,
    read_lists,
    write_lists,
)
from rtphys.results.official import result_folder, write_result
from rtphys.results.summary import Summary, summarise
from rtphys.senses import drawn
from rtphys.sim import renderer
from rtphys.spec.collection import CollectionSpec, TaskHeader
from rtphys.spec.episode import Recipe
from rtphys.spec.protocol import protocol_names
from rtphys.spec.recording import RecordingSpec
from rtphys.spec.stored import differences, stored
from rtphys.studies.collect import header_of
from rtphys.studies.collect_worker import CollectWorker
from rtphys.studies.requests import EvaluationRun
from rtphys.studies.worker import StudyWorker
from rtphys.task.props import parts
from rtphys.task.spec import Task

SHORT = 200  # characters that a dataset keeps of what a policy raised
LONGEST_TRACE = 100_000  # characters that a record keeps of it; the message may hold anything


def evaluate(
    spec: EvaluationSpec, run: EvaluationRun, pack: Pack, listener: Listener = QUIET
) -> Summary:
    """Runs a policy on its instances and returns the summary, which is also written.

    Records and summary depend on the instances and the policy alone, not on the number of workers,
    nor on how often the run was killed and resumed. Raises `RtphysError`: what
    `EvaluationRun.check` and `certified` refuse; results of another evaluation in the folder; a
    policy that cannot be reached; an error in a worker.
    """
    tasks = {task.name: task for task in run.check(spec)}
    joints = check_robot(pack, spec.episode.embodiment).action_layout.per_arm
    digest, out = files_digest(spec.policy, spec.options), run.folder(spec.policy)
    cells = [
        EvaluationHeader(
            spec.of(protocol, name),
            fingerprint_of(task, protocol, pack, spec.episode.embodiment),
            digest,
        )
        for protocol in run.protocols
        for name, task in tasks.items()
    ]
    lists = [certified(run, *cell.spec.key, cell.fingerprint) for cell in cells]
    if clauses := {clause for one in lists for clause in other_versions(one.fingerprint)}:
        text = "the lists were certified with other versions, last bits of states may differ: "
        listener.noticed(text + "; ".join(sorted(clauses)))
    if run.record is not None and run.record.resolve() == out.resolve():
        raise BadValue("record", str(run.record), "another folder than that of the results")
    files.make_folder(out)
    with FolderLock(out), DatasetWriter(run.record) if run.record else nullcontext() as dataset:
        _check_others(out, cells[0])
        studies = list[EvaluationSeries]()
        for cell, one in zip(cells, lists, strict=True):
            writer = None
            if dataset is not None:
                writer = dataset.task(
                    recording_header(cell.spec, one, tasks[one.task], pack, digest)
                )
            studies.append(EvaluationSeries(out, cell, one, run.video, writer, joints))
        for protocol in run.protocols:  # now that nothing is refused any more
            path = list_file(out / evaluation.INSTANCES, protocol)
            known = read_lists(path) if path.is_file() else {}
            # One that goes further stays: more episodes were asked for once, and are there.
            copied = [one for one in lists if one.protocol == protocol]
            write_lists(path, (one for one in copied if not one.begins(known.get(one.task))))
        if earlier := sum(study.progress.accepted for study in studies):
            text = f"{counted(earlier, 'episodes')} of an earlier run in {out} stand"
            listener.noticed(text + "; they get no new videos" * (run.video is not None))
        worker = EvaluateWorker(pack, spec.policy, spec.recording)
        saved = dataset.checkpoint_if_due if dataset else lambda: None
        run_here(
            studies, worker, run.workers, listener, out, user_seconds=run.timeout, committed=saved
        )
        return _conclude(out, spec, studies)


def _check_others(out: Path, now: EvaluationHeader) -> None:
    """Refuses a folder whose ledgers are those of another evaluation, of whatever tasks.

    Raises `DatasetMismatch`, `BadFile`.
    """
    for before in evaluation.headers(out).values():
        same = stored(now.spec.of(*before.spec.key))
        clauses = differences(stored(before.spec), same)
        if clauses := clauses + edited(before.policy_files, now.policy_files):
            raise DatasetMismatch(out, clauses)


def _conclude(out: Path, spec: EvaluationSpec, studies: "Sequence[EvaluationSeries]") -> Summary:
    """Writes the summary, figures of it, and RoboTwin's result files."""
    summary = summarise(
        {study.spec.key: study.records for study in studies},
        {study.spec.key: study.instances for study in studies},
        {study.spec.key: study.fingerprint for study in studies},
    )
    policy, episode = spec.short_actor, spec.episode
    what = {"policy": spec.policy, "policy_options": dict(spec.options), "policy_seed": spec.seed}
    what |= {"split": episode.split, "sentences": spec.hears, "embodiment": episode.embodiment}
    files.replace_file(out / evaluation.SUMMARY, pretty({**what, **summary.to_json()}))
    for (
        protocol
    ) in protocol_names():  # of an earlier run, of other protocols, tasks or more episodes
        (out / f"attributes_{protocol}.png").unlink(missing_ok=True)
    for protocol, effects in summary.breaks.items():
        if effects:
            place = out / f"attributes_{protocol}.png"
            files.replace_file(place, draw_breaks(effects, f"{policy} under {protocol}"))
    for row in summary.tasks:
        folder = result_folder(out, row.task, policy, row.protocol)
        counts = row.counts.rollouts, row.counts.tried, row.counts.successes
        write_result(folder, row.protocol, spec.hears, counts)
    return summary


# ---- one task under one protocol, in one worker --------------------------------------------


class EvaluationTask(NamedTuple):
    """One episode, and where its files go."""

    recipe: Recipe
    setup: PolicySetup
    video_folder: Path | None = None  # the result folder that takes its video
    of_failure: bool = False  # write it only if the policy fails
    staging: Path | None = None  # folder for the files of a recorded episode


class EvaluationResult(NamedTuple):
    """An evaluated episode; `outcome`: what a dataset takes of it, where there is one."""

    record: EpisodeRecord
    outcome: StagedEpisode | Rejection | None = None


class EvaluationSeries(Series[EvaluationTask, EvaluationResult]):
    """One task under one protocol: its instances in order, and their records in a ledger.

    Args:
        video: of which episodes, as `EvaluationRun` has it.
        writer: of the dataset that takes the episodes, the failed ones as rejections.
    """

    def __init__(
        self,
        out: Path,
        header: EvaluationHeader,
        instances: InstanceList,
        video: str | None = None,
        writer: TaskWriter | None = None,
        arm_joints: tuple[int, int] = (6, 6),
    ) -> None:
        self.spec, self.instances, self.writer = header.spec, instances, writer
        self.fingerprint = header.fingerprint
        spec, of = self.spec, self.spec.episode
        self._setup = PolicySetup(
            of.task, of.protocol, spec.hears, spec.seed, spec.options, of.embodiment, arm_joints
        )
        self._out, self._video = out, video
        count = int(video) if video and video.isdecimal() else len(instances.feasible)
        self._shown = {one.seed for one in instances.feasible[:count]} if video else set[int]()
        self._all: list[EpisodeRecord] = []
        path = evaluation.ledger_file(out, *spec.key)
        self._ledger = Ledger(path, header, EpisodeRecord, self._all.append)
        seeds = [one.seed for one in instances.feasible]
        before = [record.seed for record in self._all]
        # A longer run may stand there: more episodes were asked for once.
        if before[: len(seeds)] != seeds[: len(before)]:
            raise BadFile(path, "its seeds are not those of the instance list")
        done = min(len(before), len(seeds))
        missing = sum(seed >= writer.next_seed for seed in seeds[:done]) if writer else 0
        if missing:
            text = f"holds {counted(missing, 'episodes')} that were run without recording"
            raise BadFile(path, f"{text}; evaluate into another folder to record them")
        name = f"{of.task}, {of.protocol}"
        solved = sum(one.success for one in self._all[:done])
        super().__init__(Progress(name, len(seeds), done, done, solved=solved), seeds[done:])

    @property
    def records(self) -> Sequence[EpisodeRecord]:
        """Those of the episodes asked for."""
        return self._all[: self.progress.wanted]

    def job(self, seed: int) -> EvaluationTask:
        # Absolute, since a policy may change the working directory.
        video_folder = self._out.absolute() if seed in self._shown else None
        staging = self.writer.staging(seed) if self.writer else None
        recipe, failures = self.spec.episode.at(seed), self._video == "failures"
        return EvaluationTask(recipe, self._setup, video_folder, failures, staging)

    def commit(self, seed: int, result: EvaluationResult) -> str:
        if self.writer is not None and result.outcome is not None:
            rows, of_row = self.instances.instances, attrgetter("seed")
            start, end = (bisect_left(rows, at, key=of_row) for at in (self.writer.next_seed, seed))
            for one in rows[start:end]:  # first the seeds that certification left out
                self.writer.record(Rejection(one.seed, "not_certified", one.reason))
            if seed >= self.writer.next_seed:
                self.writer.record(result.outcome)
            else:  # it is there: a kill came before the ledger had it, or somebody deleted that
                self.writer.discard(seed)
            self.writer.sync()  # a crash of the machine must not leave the record alone
        self._ledger.append(result.record)
        self._all.append(result.record)
        return ""

    def success(self, result: EvaluationResult) -> bool:
        return result.record.success

    def lost(self, seed: int, loss: WorkerFailure) -> EvaluationResult:
        return unplayed(self.spec.episode.at(seed), loss.reason, loss.detail)


def unplayed(recipe: Recipe, reason: str, detail: str) -> EvaluationResult:
    """An episode that never came to its end: nothing of it can be kept."""
    task, protocol, seed = recipe.task, recipe.protocol, recipe.seed
    record = EpisodeRecord(task, protocol, seed, False, reason=reason, detail=detail)
    return EvaluationResult(record, rejection(Attempt(recipe, reason, detail[-SHORT:])))


def recording_header(
    spec: EvaluationSpec, instances: InstanceList, task: Task, pack: Pack, policy_files: str = ""
) -> TaskHeader:
    """The header of a task dataset that takes the episodes of these instances.

    A policy that was edited, of other `policy_files`, adds nothing to it.
    """
    acts = f"{spec.actor}, seed {spec.seed}"
    if policy_files:
        acts += f", files {policy_files[: evaluation.DIGITS]}"
    kept = CollectionSpec(
        spec.episode,
        spec.recording,
        episodes=len(instances.feasible),
        first_seed=instances.first_seed,
        keep_failures="all",
        policy=acts,
        made_by="collect" if instances.certified else "subset",  # seeds of a dataset have gaps
    )
    return header_of(kept, task, pack)


@dataclass
class EvaluateWorker(StudyWorker[EvaluationTask, EvaluationResult]):
    """Plays episodes with a policy, which stays open from one to the next of the same setup."""

    policy: str
    recording: RecordingSpec = field(default_factory=RecordingSpec)  # what observations show

    def __post_init__(self) -> None:
        super().__post_init__()
        self._session = PolicySession(self.policy)

    def finish(self) -> None:
        self._session.close()

    def do(self, job: EvaluationTask) -> EvaluationResult:
        """Plays one episode.

        Raises `RtphysError`: the policy cannot be opened, cannot be closed after its last episode,
        or is gone: no result of anybody's; `NoRenderer`: it needs pictures, and there is no device.
        """
        recipe, task = job.recipe, self.tasks[job.recipe.task]
        policy = self._session.policy(job.setup)
        try:
            keep = "hash" if job.video_folder is None and job.staging is None else "rows"
            episode = begin(recipe, task, self.pack, self.recording, keep, job.setup.split)
        except Infeasible as problem:
            return unplayed(recipe, "infeasible", str(problem))
        trace = ""
        try:
            policy.play(episode)
        except (PolicyGone, KeyboardInterrupt):
            raise
        except BaseException:  # a policy's crash is its failure, not ours
            trace = traceback.format_exc()
            try:
                self._session.close()  # the next episode must not depend on what it remembers now
            except PolicyBroken as error:
                trace += f"{error}\n"
        record = _judged(episode, spelled(trace[:LONGEST_TRACE]), policy.needs_images)
        if keep == "hash":
            return EvaluationResult(record)
        instance, recording = episode.instance, episode.rollout.recorder.recording
        if job.video_folder is not None and not (record.success and job.of_failure):
            path = evaluation.video_file(
                job.video_folder, recipe.protocol, recipe.task, recipe.seed, record.success
            )
            write_video(instance, recording, self.pack, path)
        if job.staging is None:
            return EvaluationResult(record)
        renderer.hold_anchor(drawn(self.recording.senses))
        reason, detail = "", ""
        if not record.success:
            reason, detail = record.reason, record.raised[:SHORT]
        tried = Attempt(recipe, reason, detail, instance, recording, episode.finish())
        worker = CollectWorker(self.pack)
        worker.tasks[task.name] = task
        drawn_one = worker.simulated(tried, job.staging, self.recording).outcome(worker.draw)
        return EvaluationResult(record, drawn_one)


def _judged(episode: PolicyEpisode, trace: str, sees: bool) -> EpisodeRecord:
    """What the episode came to. `sees`: whether the policy is shown pictures."""
    time = episode.rollout.scene.time
    outcome, physics = episode.finish(), episode.instance.physics
    strain = episode.rollout.strain
    success, able = episode.success and not trace, could_act(physics, parts(episode.instance.props))
    if not sees:  # where the camera stands changes nothing for it
        able = {key for key in able if "camera_mode" not in attribute(key).auxiliary}
    return EpisodeRecord(
        task=episode.task,
        protocol=episode.protocol,
        seed=episode.seed,
        success=success,
        held=success and outcome.held,
        reason="policy_error" if trace else episode.reason,
        first_touch=episode.rollout.first_success,
        steps=episode.taken,
        time=time,
        unreachable=episode.unreachable,
        force=strain.force,
        torque=strain.torque,
        rough=strain.problem is not None,
        clipped=episode.log.clipped,
        language="" if success else episode.log.usual_cause(),
        physics={key: plain(value, key) for key, value in physics.items()},
        inert=tuple(sorted(attributes().keys() - able)),
        state=episode.rollout.recorder.recording.hash,
        detail=trace or outcome.detail,
    )


# ---- which instances ------------------------------------------------------------------------


def _not_certified(
    run: EvaluationRun, where: Path, problem: str, feasible: int, robot: str = DEFAULT
) -> RtphysError:
    """No list for the robot, or too short a one; its cure makes all, as they replace the others."""
    fields = f"task={','.join(run.tasks)} protocol={','.join(run.protocols)} feasible={feasible}"
    fields += " out=FOLDER" + (f" embodiment={robot}" if robot != DEFAULT else "")
    cure = f"to certify: `rtphys certify {fields}`, then set `instances`"
    return RtphysError(f"{where}: {problem}; {cure}")


def certified(
    run: EvaluationRun, protocol: str, task: str, fingerprint: Fingerprint
) -> InstanceList:
    """The instances to evaluate: the list up to the last episode that is asked for.

    They come from the file, folder or dataset that is given, else from the newest library. Raises
    `RtphysError`: there is none for the robot, or too few in it, or its task file, domain, look or
    assets have changed and `run.accept_changes` is false; `BadFile`: it is damaged, or another
    task's or protocol's.
    """
    given, least = run.instances, run.episodes or 1
    if given is not None and (given / MANIFEST).is_file():
        where, found = given, _of_dataset(given, task, protocol, fingerprint)
    else:
        folders = [given] if given else [lists_folder(root, task) for root in library.roots()]
        paths = [one if one.is_file() else list_file(one, protocol) for one in folders]
        read = [(path, read_list(path, task)) for path in paths if path.is_file()]
        where, found = next((pair for pair in reversed(read) if pair[1]), (paths[0], None))
        if found is None:
            problem = f"has no list of {task}" if where.is_file() else "does not exist"
            raise _not_certified(run, where, problem, run.episodes or 100)
        if found.protocol != protocol:  # accepted changes must not hide it
            raise BadFile(where, f"is the list of {found.task}, {found.protocol}")
        if (robot := found.fingerprint.embodiment) != (own := fingerprint.embodiment):
            problem = f"is certified for the robot {robot}, which says nothing of {own}"
            raise _not_certified(run, where, problem, run.episodes or 100, own)
    if (feasible := len(found.feasible)) < least:
        problem = f"{task}, {protocol}: holds {feasible} feasible seeds, not {least}"
        raise _not_certified(run, where, problem, least)
    clauses = found.fingerprint.changes(fingerprint)
    if clauses and not run.accept_changes:
        raise RtphysError(
            f"{where}: has another certification fingerprint: {'; '.join(clauses)}. What was "
            "feasible may not be so now: certify anew, or set `accept_changes`"
        )
    return found.first(run.episodes or feasible)


def other_versions(fingerprint: Fingerprint) -> list[str]:
    """One clause for each package whose version is not the list's; they are allowed to differ.

    Python's own version moves no bit, and what rtphys does is compared by its code.
    """
    known = fingerprint.versions
    return [
        f"{name} was {known[name]}, now {version}"
        for name, version in packages().items()
        if name in known and known[name] != version and name not in ("rtphys", "python")
    ]


def _of_dataset(folder: Path, task: str, protocol: str, fingerprint: Fingerprint) -> InstanceList:
    """Every seed that was tried for a dataset; its manifest has vouched for the ground."""
    robot = embodiment_folder(fingerprint.embodiment)
    every = [entry for entry in Dataset(folder).task_datasets if entry.spec.episode.task == task]
    entries = [e for e in every if embodiment_folder(e.spec.episode.embodiment) == robot]
    if not entries:
        others = sorted({entry.spec.episode.embodiment for entry in every})
        apart = f" with the robot {robot}, only with {', '.join(others)}; set `embodiment`"
        problem = f"the dataset has no episodes of {task}{apart if every else ''}"
        raise BadValue("instances", str(folder), problem)

    def fit(entry: TaskEntry) -> tuple[bool, ...]:
        name, recorded = entry.spec.name, entry.spec.episode.protocol
        return not _unfit(entry.spec), name == protocol, recorded == protocol, name == recorded

    # Another protocol's seeds will do: the layout of a seed is the same under every one.
    entry = max(entries, key=fit)
    own = protocol in (entry.spec.name, entry.spec.episode.protocol)
    if problem := _unfit(entry.spec):
        raise BadValue("instances", str(folder), problem)
    instances = tuple(
        BenchmarkInstance(row.seed, row.reason if isinstance(row, Rejected) else "")
        for row in entry.rows(folder)
    )
    under = "" if own else entry.spec.name
    return InstanceList(task, protocol, fingerprint, instances, tried_under=under)


def _unfit(spec: CollectionSpec) -> str:
    """Why the seeds of a task dataset are no instances; empty: they are."""
    if spec.episode.only is not None or spec.episode.overrides:
        return "attributes were picked or held in it, which an evaluation does not know"
    if spec.episode.ranges is not None:
        return "its physics was drawn from `ranges`, which an evaluation does not know"
    if spec.policy is not None:
        return f"its episodes are those of {spec.policy}, which says nothing of feasibility"
    if spec.episode.pair_tasks:
        return "its tasks share one draw, and an evaluation draws for each task by itself"
    return ""
