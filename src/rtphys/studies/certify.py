"""`certify`: finds the seeds on which policies are evaluated, those that the expert solves."""

from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import NamedTuple

from rtphys.assets.pack import Pack
from rtphys.campaign.local import run_here
from rtphys.campaign.pool import WorkerFailure
from rtphys.campaign.series import FRUITLESS, QUIET, Batch, Listener, Progress, Series
from rtphys.core.errors import BadValue, UnknownName
from rtphys.data.faults import DatasetMismatch
from rtphys.data.files import make_folder
from rtphys.data.ledger import Ledger
from rtphys.data.lock import FolderLock
from rtphys.episode.fingerprint import fingerprint_of
from rtphys.plan.kinematics import check_robot
from rtphys.results.instances import (
    HASH_LENGTH,
    BenchmarkInstance,
    Fingerprint,
    InstanceList,
    list_file,
    read_list,
    read_lists,
    write_lists,
)
from rtphys.spec.episode import EpisodeSpec, Recipe
from rtphys.spec.option import checked_dataclass
from rtphys.spec.protocol import load_protocol
from rtphys.spec.stored import CLOSED, differences, stored
from rtphys.studies.requests import REPLAYS, CertificationRun, CertificationSpec
from rtphys.studies.worker import StudyWorker
from rtphys.task.spec import load_task

Names = tuple[str, ...]


@checked_dataclass(frozen=True, config=CLOSED)
class CertificationHeader:
    """The first line of the log of a list in the making."""

    spec: CertificationSpec
    fingerprint: Fingerprint


@checked_dataclass(frozen=True, config=CLOSED)
class MeasuredInstance:
    """A row of the log."""

    instance: BenchmarkInstance
    measured: Names  # replays


class CertificationTask(NamedTuple):
    """One seed, and what to measure on it if it is feasible."""

    recipe: Recipe
    replays: Names = ()


class CertifyWorker(StudyWorker[CertificationTask, BenchmarkInstance]):
    """Lets the expert try a seed, without pictures, and measures replays on a feasible one."""

    def do(self, job: CertificationTask) -> BenchmarkInstance:
        recipe, alone, twin = job.recipe, None, None
        tried = self.demonstrate(recipe)
        if not tried.accepted or tried.recording is None:
            return BenchmarkInstance(recipe.seed, tried.reason)
        if "replay" in job.replays:
            alone = self.replay(recipe, tried)
        if "twin" in job.replays:
            clean = recipe.spec.under("clean").at(recipe.seed)
            twin = self.replay(recipe, self.demonstrate(clean))
        state = tried.recording.hash[:HASH_LENGTH]
        return BenchmarkInstance(recipe.seed, "", state, alone, twin)


class CertificationSeries(Series[CertificationTask, BenchmarkInstance]):
    """One certified list in the making: known rows gain the replays they lack, new seeds follow.

    A list's replays only grow: every row is owed all that were ever measured or asked for, or
    else a list would depend on the order of the questions. The list is written when it is whole;
    until then a ledger beside its file holds what is new, the newest line of a seed being in force.
    Raises `DatasetMismatch`: what is there has another fingerprint or first seed; `BadFile`,
    `UnknownName`: it is damaged; it names an open-loop replay that does not exist.
    """

    def __init__(self, out: Path, spec: CertificationSpec, fingerprint: Fingerprint) -> None:
        self.spec, self.fingerprint = spec, fingerprint
        task, protocol = spec.episode.task, spec.episode.protocol
        self.path = list_file(out, protocol)
        self._rows: dict[int, BenchmarkInstance] = {}  # by seed
        self._measured: dict[int, Names] = {}  # likewise
        header = CertificationHeader(spec, fingerprint)
        self._written = read_list(self.path, task) if self.path.exists() else None
        if (known := self._written) is not None:
            before = CertificationHeader(
                replace(spec, first_seed=known.first_seed), known.fingerprint
            )
            if clauses := differences(stored(before), stored(header)):
                raise DatasetMismatch(f"{self.path}, {task}", clauses)
            for name in {*known.replays}.difference(REPLAYS):
                raise UnknownName("open-loop replay", name, REPLAYS, self.path)
            for one in known.instances:
                self._put(MeasuredInstance(one, known.replays))
        path = out / f".{protocol}.{task}.ledger"
        self._ledger = Ledger(path, header, MeasuredInstance, self._put)
        named = {*spec.replays}.union(*self._measured.values())
        self.replays = tuple(name for name in REPLAYS if name in named)
        self._physics = load_protocol(protocol).physics
        found = self.instances
        lacking = [one.seed for one in found.feasible if self._lacks(one.seed)]
        name = f"{task}, {protocol}"
        progress = Progress(name, spec.feasible, len(found.feasible), found.attempts)
        accepted = [True, *(one.feasible for one in found.instances)]
        progress.fruitless = min(accepted[::-1].index(True), FRUITLESS)
        new = range(spec.first_seed, spec.first_seed + spec.max_attempts)[found.attempts :]
        super().__init__(progress, [*lacking, *new], owed=len(lacking))

    def _put(self, row: MeasuredInstance) -> None:
        """What is neither known nor next stays out: the list it belonged to was deleted."""
        one, first = row.instance, self.spec.first_seed
        known = one.seed in self._rows or one.seed == first + len(self._rows)
        # A row that holds less than the list is older than the list.
        if known and {*self._measured.get(one.seed, ())} <= {*row.measured}:
            self._rows[one.seed], self._measured[one.seed] = one, row.measured

    def _lacks(self, seed: int) -> Names:
        """Without physics a twin would be the same world, and is not measured."""
        lacking = {*self.replays}.difference(self._measured.get(seed, ()))
        return tuple(n for n in self.replays if n in lacking and (self._physics or n != "twin"))

    def job(self, seed: int) -> CertificationTask:
        return CertificationTask(self.spec.episode.at(seed), self._lacks(seed))

    def reason(self, result: BenchmarkInstance) -> str:
        return result.reason

    def commit(self, seed: int, result: BenchmarkInstance) -> str:
        if known := self._rows.get(seed):
            if result.state != known.state:
                now = result.reason or f"state {result.state}"
                return self._halt(
                    seed,
                    f"came out otherwise than in the list: {now}, not state {known.state}; "
                    "a list made on another kind of machine cannot be added to here",
                )
            new = {name: getattr(result, name) for name in self._lacks(seed)}
            result = known._replace(**new)
        self._put(row := MeasuredInstance(result, self.replays))
        self._ledger.append(row)
        return ""

    def lost(self, seed: int, loss: WorkerFailure) -> str:
        return self._halt(
            seed,
            f"{loss.reason}: the last worker that tried it {loss.detail}, which "
            "is no verdict on the seed; the same command tries it again",
        )

    def _halt(self, seed: int, text: str) -> str:
        kept = f"the list in {self.path} is not written yet; what is finished is kept beside it"
        return f"seed {seed}: {text}. {kept}"

    def close(self) -> None:
        """Writes the list if it is whole. Raises `CannotWrite`."""
        if self.whole:
            if self.instances != self._written:
                write_lists(self.path, [self.instances])
            self._ledger.path.unlink(missing_ok=True)

    @property
    def whole(self) -> bool:
        """Whether nothing can be added to it."""
        return self.enough and not self.halted

    @property
    def instances(self) -> InstanceList:
        """What is known so far."""
        of, rows = self.spec.episode, tuple(self._rows.values())
        return InstanceList(of.task, of.protocol, self.fingerprint, rows, self.replays)


def certify(
    spec: CertificationSpec, run: CertificationRun, pack: Pack, listener: Listener = QUIET
) -> list[CertificationSeries]:
    """Certifies until every list has its feasible seeds, is given up, or meets a lost worker.

    The lists depend on the spec alone, not on the number of workers, nor on how often the run was
    killed and resumed. A seed that takes its workers with it has no verdict: its list stays as it
    is, its `halted` says why, and the same call goes on there. Raises `RtphysError`: a list with
    another fingerprint; another run at work in the folder; an error in a worker.
    """
    check_robot(pack, spec.episode.embodiment)
    make_folder(run.out)
    with FolderLock(run.out):
        lists = [
            CertificationSeries(run.out, one, _fingerprint(one.episode, pack))
            for one in run.specs(spec)
        ]
        run_here(lists, CertifyWorker(pack), run.workers, listener, run.out)
    return lists


def _fingerprint(spec: EpisodeSpec, pack: Pack) -> Fingerprint:
    return fingerprint_of(load_task(spec.task), spec.protocol, pack, spec.embodiment)


@dataclass
class Reproof:
    """The first instances of one list, solved again."""

    path: Path
    listed: InstanceList
    fingerprint: Fingerprint  # as it is now
    differences: list[str] = field(default_factory=list[str])  # one sentence for each seed
    solved: int = 0

    @property
    def stale(self) -> bool:
        """Whether the list has another fingerprint than the present one."""
        return self.listed.fingerprint != self.fingerprint

    @property
    def renewed(self) -> bool:
        """Whether the list gets the present fingerprint."""
        return bool(self.solved) and self.stale and not self.differences


def reprove(
    spec: CertificationSpec, run: CertificationRun, pack: Pack, listener: Listener = QUIET
) -> list[Reproof]:
    """Solves the first `run.reprove` instances of every list of these that is there.

    A list all of whose states agree to the last bit carries the present fingerprint afterwards. One
    that differs stays as it is, and stale. Raises `BadValue`: the folder holds none of the lists;
    `BadFile`, `SchemaError`: a list is damaged.
    """
    paths = {name: list_file(run.out, name) for name in run.protocols}
    known = {name: read_lists(path) for name, path in paths.items() if path.is_file()}
    proofs, batches = list[Reproof](), list[Batch[CertificationTask, BenchmarkInstance]]()
    for episode in (one.episode for one in run.specs(spec)):
        if (listed := known.get(episode.protocol, {}).get(episode.task)) is None:
            continue
        proofs.append(Reproof(paths[episode.protocol], listed, _fingerprint(episode, pack)))
        seeds = [one.seed for one in listed.feasible[: run.reprove]]
        jobs = {seed: CertificationTask(episode.at(seed)) for seed in seeds}
        batches.append(
            Batch(
                f"{episode.task}, {episode.protocol}",
                jobs,
                lambda job, loss: BenchmarkInstance(job.recipe.seed, loss.reason),
            )
        )
    if not proofs:
        allowed = "a folder with lists of these tasks and protocols"
        raise BadValue("out", str(run.out), allowed)
    with FolderLock(run.out):
        run_here(batches, CertifyWorker(pack), run.workers, listener)
        for proof, batch in zip(proofs, batches, strict=True):
            proof.solved = len(batch.results)
            for one in proof.listed.feasible:
                now = batch.results.get(one.seed, one)
                if now.state != one.state:
                    text = now.reason or f"state {now.state}"
                    seed = f"{proof.path}: {proof.listed.task}, seed {one.seed}"
                    proof.differences.append(f"{seed}: now {text}, not state {one.state}")
        for path in {proof.path: None for proof in proofs if proof.renewed}:
            renewed = [proof for proof in proofs if proof.path == path and proof.renewed]
            write_lists(path, [replace(one.listed, fingerprint=one.fingerprint) for one in renewed])
    return proofs
