"""`collect`: accepted episodes of many task datasets, on a campaign of worker processes."""

from collections import defaultdict
from collections.abc import Mapping, Sequence
from contextlib import suppress
from dataclasses import replace
from itertools import islice
from pathlib import Path

from rtphys.assets.pack import STAMP, Pack, default_pack
from rtphys.campaign.local import LocalPool
from rtphys.campaign.pool import Limits, WorkerFailure, WorkerPool
from rtphys.campaign.series import QUIET, Listener, Progress, Series, run_all
from rtphys.campaign.two_stages import TwoStagePool
from rtphys.core.errors import BadValue, Infeasible, MissingAsset, counted
from rtphys.data.attempts import Accepted, read_attempts
from rtphys.data.faults import DatasetMismatch
from rtphys.data.layout import TaskDataset
from rtphys.data.lock import check_unlocked
from rtphys.data.manifest import entries_there
from rtphys.data.writer import DatasetWriter, Rejection, TaskWriter
from rtphys.episode.assemble import describer, rejection
from rtphys.episode.fingerprint import versions
from rtphys.episode.generate import Attempt
from rtphys.physics.attribute import is_attribute
from rtphys.physics.idle import why_idle
from rtphys.physics.values import Value
from rtphys.plan.kinematics import check_robot
from rtphys.senses import drawn
from rtphys.sim import renderer
from rtphys.spec.collection import CollectionSpec, Resolved, TaskHeader
from rtphys.spec.episode import EpisodeSpec, check_varies
from rtphys.spec.protocol import load_protocol
from rtphys.spec.recording import HEAD
from rtphys.spec.sweep import families
from rtphys.studies.collect_worker import (
    CollectionTask,
    CollectWorker,
    Drawer,
    RemoteWorker,
    Results,
    Simulator,
    arrived,
    without_drawing,
)
from rtphys.studies.requests import Run, room_needed, shard_of
from rtphys.studies.resources import (
    check_drawable,
    check_fits,
    check_space,
    drawn_at_once,
    first_props,
    props_of,
)
from rtphys.task.instructions import check_sentences
from rtphys.task.props import check_props, parts
from rtphys.task.spec import Task, load_task

LIMITS = Limits()
DRAWERS = 4  # drawing workers of a GPU: while one reads pictures, it draws those of the others
MAX_SEEDS = 10**9  # of a series whose attempts nobody limits


def collect(
    specs: Sequence[CollectionSpec], run: Run, listener: Listener = QUIET
) -> list[Progress]:
    """Collects until every task dataset has its episodes, or is given up; progress of each.

    The dataset depends on the specs alone, not on the number of workers, nor on how often the run
    was killed and resumed. Interrupted by an exception, it leaves a valid prefix. Raises
    `RtphysError`: what `check` and `DatasetWriter` refuse; a full disk; `Bug`: an unexpected
    exception in a worker.
    """
    own = shard_of(specs, run.shard)
    tasks = check(own, run)
    size = check_machine(own, run)
    with DatasetWriter(run.out) as dataset:
        pack = default_pack(listener.building)
        check_assets(own, tasks, pack)
        series = [
            CollectionSeries(
                family,
                [
                    dataset.task(header_of(side, tasks[side.episode.task], pack))
                    for spec in family
                    for side in spec.sides
                ],
            )
            for family in families(own)
        ]
        # Its `do` runs in each worker process, once for each seed.
        worker = CollectWorker(pack, own[0].recording.shader)
        with pool_of(run, worker, own, size, listener) as workers:
            run_all(series, workers, listener, run.out, dataset.checkpoint_if_due)
    return [one.progress for one in series]


def pool_of(
    run: Run,
    worker: CollectWorker,
    specs: Sequence[CollectionSpec],
    size: int,
    listener: Listener,
) -> WorkerPool[CollectionTask, Results]:
    """Workers that do all, or, on a machine with a GPU, many that simulate and few that draw."""
    if run.runner == "ray":
        from rtphys.campaign.ray import RayPool  # imported here: Ray is optional

        return RayPool(RemoteWorker.of(worker, specs), size, LIMITS)
    gpus = check_drawable(shader=worker.shader) if run.gpus is None else run.gpus
    if not gpus:
        return LocalPool(worker, size, LIMITS)
    group = min(drawn_at_once(spec.recording) for spec in specs)
    drawing = replace(LIMITS, seconds=group * LIMITS.seconds, memory=LIMITS.max_memory)
    numbers = [None] if gpus == 1 else range(gpus)
    drawers = [LocalPool(Drawer(worker, number), DRAWERS, drawing) for number in numbers]
    many, few = counted(size, "workers"), DRAWERS * gpus
    listener.noticed(f"{many} simulate, {few} draw on {counted(gpus, 'GPUs')}, {group} at a time")
    return TwoStagePool(LocalPool(Simulator(worker), size, LIMITS), drawers, group, without_drawing)


def header_of(spec: CollectionSpec, task: Task, pack: Pack) -> TaskHeader:
    """A spec, and what its names stand for now. Raises `RtphysError`: the robot cannot be."""
    episode, visual = spec.episode, spec.episode.visual()
    check_robot(pack, episode.embodiment)
    name = "builtin" if (pack.root / STAMP).is_file() else pack.root.name
    resolved = Resolved(
        domain=episode.domain.to_json(),
        visual=None if visual is None else visual.to_json(),
        versions=versions(task, episode.embodiment),
        assets={"pack": name, "digest": pack.digest},
    )
    return TaskHeader(spec, resolved)


class CollectionSeries(Series[CollectionTask, Results]):
    """Task datasets of the same seeds, such as a twin's or a sweep's: a writer each, in step.

    A kill between two commits leaves one writer ahead of the others; the seed is then tried again
    for those that lack it.

    Args:
        family: a spec, or one for each value of a sweep; `writers`: one for each of their sides.
    """

    def __init__(self, family: Sequence[CollectionSpec], writers: Sequence[TaskWriter]) -> None:
        spec = self.spec = family[0]
        self.writers = writers
        self.sides = [side for one in family for side in one.sides]
        behind = min(writers, key=lambda writer: writer.totals.attempts)
        # Of each writer, which seeds that another one lacks gave an episode.
        self._there = [accepted_after(behind.totals.attempts, writer) for writer in writers]
        name = spec.episode.task
        if len(family) > 1:
            name += f", {spec.sweep}"
        elif spec.name != spec.episode.protocol:
            name += f", {spec.name}"
        complete, fruitless = behind.totals.episodes, behind.totals.since_accepted
        if behind.totals.attempts and not spec.paired:
            complete, fruitless = accepted_by_all(writers)
        progress = Progress(name, behind.wanted, complete, behind.totals.attempts)
        progress.fruitless = fruitless
        step = spec.seed(1) - spec.seed(0)
        end = spec.first_seed + (spec.max_attempts or MAX_SEEDS)
        super().__init__(progress, range(behind.next_seed, end, step))

    def job(self, seed: int) -> CollectionTask:
        return CollectionTask(
            tuple(side.episode.at(seed) for side in self.sides),
            tuple(writer.staging(seed) for writer in self.writers),
            self.spec.recording,
            tuple(writer.wants_failures for writer in self.writers),
            self.spec.paired,
        )

    def reason(self, result: Results) -> str:
        return next((one.reason for one in result if isinstance(one, Rejection)), "")

    def arrived(self, seed: int, result: Results) -> Results:
        """Files from other machines are put where those of this one are."""
        places = (writer.staging(seed) for writer in self.writers)
        return tuple(map(arrived, result, places))

    def commit(self, seed: int, result: Results) -> str:
        """Raises `DatasetMismatch`: an attempt that a twin holds came out otherwise this time."""
        for writer, outcome, there in zip(self.writers, result, self._there, strict=True):
            rejected = isinstance(outcome, Rejection)
            if seed >= writer.next_seed:
                writer.record(outcome)
                self.progress.made += not rejected
            elif rejected == there[seed]:
                now = f"rejected ({outcome.reason})" if rejected else "accepted"
                clause = f"seed {seed} is {now} when its twin is made, and was not before"
                raise DatasetMismatch(writer.task_dataset.folder, [clause])
            else:
                writer.discard(seed)
        return ""

    def lost(self, seed: int, loss: WorkerFailure) -> Results:
        recipes = [side.episode.at(seed) for side in self.sides]
        return tuple(rejection(Attempt(recipe, loss.reason, loss.detail)) for recipe in recipes)

    def dropped(self, seed: int) -> None:
        for writer in self.writers:
            writer.discard(seed)


def accepted_after(attempts: int, writer: TaskWriter) -> dict[int, bool]:
    """Seeds of what a writer has committed after so many attempts, and whether they succeeded."""
    if writer.totals.attempts == attempts:
        return {}
    rows = islice(read_attempts(writer.task_dataset.ledger), attempts, None)
    return {row.seed: isinstance(row, Accepted) for row in rows}


def accepted_by_all(writers: Sequence[TaskWriter]) -> tuple[int, int]:
    """How many seeds gave an episode in each, and how many were tried after the last of these."""
    complete = fruitless = 0
    ledgers = (read_attempts(writer.task_dataset.ledger) for writer in writers)
    for rows in zip(*ledgers, strict=False):  # a kill leaves some an attempt ahead
        whole = all(isinstance(row, Accepted) for row in rows)
        complete, fruitless = complete + whole, 0 if whole else fruitless + 1
    return complete, fruitless


# ---- what is refused before any work -----------------------------------------------------------


def check(specs: Sequence[CollectionSpec], run: Run) -> dict[str, Task]:
    """The tasks by name; refuses what no machine could collect.

    Raises `RtphysError`: names the nearest match, the place, or the cure.
    """
    folders = [TaskDataset.of(run.out, spec).name for spec in specs]
    if twice := next((folder for folder in folders if folders.count(folder) > 1), None):
        raise BadValue("task", twice, "it is collected twice")
    tasks = dict[str, Task]()
    shader = specs[0].recording.shader
    for spec in specs:
        episode, recording = spec.episode, spec.recording
        if recording.shader != shader:
            raise BadValue("shader", recording.shader, f"this run draws with {shader!r} already")
        check_fits(recording)
        if HEAD not in recording.official:
            cameras = ",".join(recording.cameras)
            raise BadValue("cameras", cameras, "head is needed, for the video")
        if episode.ranges is not None and episode.only is None:
            check_varies(episode.ranges, (episode.protocol,))
        if any(side.episode == episode for side in spec.sides[1:]):
            raise BadValue("twin", spec.twin, "it is the protocol itself; name another")
        task = load_task(episode.task)
        with suppress(Infeasible):  # another seed has a layout
            props = task.props(spec.first_seed)
            check_props([*episode.draw(0), *(episode.only or ())], props)
            if spec.sweep and (why := why_idle(spec.swept[0], episode.draw(0), parts(props))):
                clause = f"it could not act in {task.name}, whose episodes would be equal: {why}"
                raise BadValue("sweep", spec.sweep, clause)
        check_sentences(task)
        tasks[task.name] = task
    if any(drawn(spec.recording.senses) for spec in specs):
        renderer.check_senses(shader)
    return tasks


def check_machine(specs: Sequence[CollectionSpec], run: Run) -> int:
    """Number of workers; refuses what cannot be done here and now, in a second or two.

    Raises `RtphysError`: names the cure.
    """
    check_unlocked(run.out)
    check_space(run.out, room_needed(missing(specs, run.out)))
    check_drawable(shader=specs[0].recording.shader)
    return run.size()


def missing(specs: Sequence[CollectionSpec], out: Path) -> list[CollectionSpec]:
    """Each side with the episodes, and the failures, that it still lacks. Raises `BadFile`."""
    there, left = entries_there(out), list[CollectionSpec]()
    for side in (side for spec in specs for side in spec.sides):
        entry = there.get(TaskDataset.of(out, side).name)
        episodes = side.episodes - (entry.episodes if entry else 0)
        failures, keep = side.max_failures - (entry.failures if entry else 0), side.keep_failures
        if keep != "all":
            keep = str(failures) if failures > 0 else None
        if episodes > 0:
            left.append(replace(side, twin=None, episodes=episodes, keep_failures=keep))
    return left


def check_assets(specs: Sequence[CollectionSpec], tasks: Mapping[str, Task], pack: Pack) -> None:
    """Reads every model of each task's first layouts. Raises `MissingAsset`, `BadFile`."""
    read = describer(pack)
    for spec in specs:
        task = tasks[spec.episode.task]
        try:
            for prop in props_of(task, first_seed=spec.first_seed):
                read(prop)
        except MissingAsset as error:
            raise MissingAsset(error.what, error.where, task.name) from error


def without_effect(specs: Sequence[CollectionSpec]) -> list[str]:
    """One sentence for each attribute that is asked for by name where it could not act.

    By `only`, by a value that is held, or by a protocol that varies it alone; a sweep is refused.
    """
    asked = defaultdict[str, set[str]](set)
    idle = defaultdict[tuple[str, str], dict[str, None]](dict[str, None])
    for spec in specs:
        task = spec.episode.task
        has = parts(first_props(load_task(task), spec.first_seed))
        for episode in (side.episode for side in spec.sides):
            swept = [spec.swept[0]] if spec.sweep else []
            asks = {key: value for key, value in _asked(episode).items() if key not in swept}
            keys = episode.draw(spec.first_seed).keys() if asks else ()
            for key, value in sorted(asks.items()):
                asked[key].add(task)
                if has and (why := why_idle(key, keys, has, value)):
                    idle[key, why][task] = None
    sentences: list[str] = []
    for (key, why), tasks in idle.items():
        first = next(iter(tasks))
        many = f"{len(tasks)} of {counted(len(asked[key]), 'tasks')}, among them {first}"
        sentences.append(f"{key} could not act in {first if len(tasks) == 1 else many}: {why}")
    return sentences


def _asked(episode: EpisodeSpec) -> dict[str, Value]:
    """Attributes that are named, and the values at which they are held; None: drawn."""
    named = (*(episode.only or ()), *load_protocol(episode.protocol).only)
    found = dict.fromkeys(named) | dict(episode.overrides)
    return {key: value for key, value in found.items() if is_attribute(key)}
