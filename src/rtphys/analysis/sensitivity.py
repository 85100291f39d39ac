"""`sensitivity`: how far one attribute at a time may be from nominal before a task is lost."""

from collections.abc import Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, field, replace
from typing import Any, NamedTuple

from rtphys.assets.pack import Pack
from rtphys.campaign.local import LocalPool, limits_for_user_code
from rtphys.campaign.machine import cores
from rtphys.campaign.pool import WorkerFailure
from rtphys.campaign.series import QUIET, Listener, Progress, Series, run_all
from rtphys.core.errors import Infeasible, shortened
from rtphys.core.untrusted import JSON
from rtphys.data import files
from rtphys.data.faults import DatasetMismatch
from rtphys.data.json_text import pretty
from rtphys.data.ledger import Ledger, read_header
from rtphys.data.lock import FolderLock
from rtphys.episode import begin
from rtphys.episode.fingerprint import fingerprint_of
from rtphys.episode.generate import Attempt, prepare
from rtphys.physics.attribute import attribute
from rtphys.physics.distribution import By, Distribution, extremes
from rtphys.physics.domain import Domain
from rtphys.physics.idle import why_idle
from rtphys.physics.load import domain_for_task
from rtphys.physics.values import Value, Vector
from rtphys.policies import (
    PolicyBroken,
    PolicyGone,
    PolicySession,
    PolicySetup,
    check_task,
    files_digest,
)
from rtphys.policies.policy import one_line
from rtphys.policies.registry import edited
from rtphys.results.statistics import wilson
from rtphys.spec.episode import EpisodeSpec
from rtphys.spec.option import checked_dataclass
from rtphys.spec.stored import stored
from rtphys.studies.requests import DEMONSTRATION, SearchSpec, SensitivityPlan
from rtphys.studies.resources import first_props
from rtphys.studies.worker import StudyWorker
from rtphys.task.props import parts
from rtphys.task.spec import load_task

FORMAT = 2  # of a result file
MAX_ATTEMPTS = 10  # seeds tried for each paired one
EXPERT = "expert"
NOMINAL = "clean"


@dataclass(frozen=True)
class Axis:
    """One side of one attribute's range. Share 0 is the nominal value, share 1 the end.

    A vector (`center_of_mass`) goes towards the seed's own draw from the whole range, which lies
    inside every body. Where the nominal value is the asset's own (`object_joint_damping`), the
    axis begins at the lower end of the range.
    """

    key: str
    nominal: float
    end: float
    needs: Mapping[str, Value] = field(default_factory=dict[str, Value])  # such as a camera's mode
    vector: bool = False

    @property
    def name(self) -> str:
        return f"{self.key} to {self.end:g}"

    def value(self, share: float) -> float:
        """The value at a share of the way; of a vector the share itself times the range's end."""
        return self.end if share == 1 else self.nominal + share * (self.end - self.nominal)

    def overrides(self, share: float, drawn: Vector) -> dict[str, Value]:
        """What to set in an episode; `drawn` is its own draw of a vector."""
        if self.vector:
            return {self.key: tuple(share * x for x in drawn)}
        return {**self.needs, self.key: self.value(share)}


def axes(domain: Domain, key: str) -> list[Axis]:
    """Both sides of an attribute's range in a domain, or the one that there is; empty if nominal.

    Where the whole range lies on one side, it is the farther end: the other one is on the way.
    """
    varied, (_, rule), needs = attribute(key), domain.drawn_by(key), dict[str, Value]()
    if isinstance(rule, By):  # the branch that reaches farthest
        selector = rule.selector
        mode, rule = max(rule.branches.items(), key=lambda branch: max(map(abs, _ends(branch[1]))))
        needs = {selector: mode}
    low, high = _ends(rule)
    if varied.size > 1:
        return [Axis(key, 0.0, max(abs(low), abs(high)), needs, vector=True)] if low < high else []
    nominal = float(varied.nominal) if isinstance(varied.nominal, int | float) else low
    if not low <= nominal <= high:
        return [Axis(key, nominal, max((low, high), key=lambda end: abs(end - nominal)), needs)]
    return [Axis(key, nominal, end, needs) for end in (low, high) if end != nominal]


def _ends(rule: Distribution) -> tuple[float, float]:
    numbers = [v for v in extremes(rule) if isinstance(v, float)]
    return (min(numbers), max(numbers)) if numbers else (0.0, 0.0)


@dataclass
class Level:
    """Results at one share of an axis."""

    share: float
    successes: int = 0
    of: int = 0

    @property
    def tolerated(self) -> bool:
        """Whether at least half of the seeds succeed."""
        return 2 * self.successes >= self.of


@dataclass
class Bisection:
    """Tests the end, then halves what is open, `steps` times. Assumes that success only falls."""

    axis: Axis
    steps: int
    levels: list[Level] = field(default_factory=list[Level])

    @property
    def bracket(self) -> tuple[float, float]:
        """Largest tolerated share and smallest that is not; both 1 where the end is tolerated."""
        low = max((level.share for level in self.levels if level.tolerated), default=0.0)
        high = min((level.share for level in self.levels if not level.tolerated), default=1.0)
        return min(low, high), high

    @property
    def next(self) -> float | None:
        """The share to test next; None when the answer stands."""
        if not self.levels:
            return 1.0
        if self.levels[0].tolerated or len(self.levels) > self.steps:
            return None
        return sum(self.bracket) / 2

    @property
    def interval(self) -> tuple[float, float]:
        """Shares between which the answer lies with 95 % confidence, as far as they were tested.

        Up to the first, more than half of the seeds are sure to succeed; from the second on, fewer.
        """
        sure = [(level.share, wilson(level.successes, level.of)) for level in self.levels]
        above = [share for share, (low, _) in sure if low > 0.5]
        below = [share for share, (_, high) in sure if high < 0.5]
        return max(above, default=0.0), min(below, default=1.0)

    def to_json(self) -> dict[str, JSON]:
        """Values, not shares; levels in the order in which they were tested."""
        value = self.axis.value
        return {
            "end": self.axis.end,
            "tolerance": value(self.bracket[0]),
            "interval": [value(share) for share in self.interval],
            "levels": [
                {"value": value(one.share), "successes": one.successes, "of": one.of}
                for one in self.levels
            ],
        }


def answer(sides: Sequence[Bisection]) -> dict[str, JSON]:
    """The result for one attribute: its range, the tolerated part of it, and all levels tested.

    `share` is the tolerated part of the range's width. `nominal` is what the search began at.
    """
    nominal, ends = sides[0].axis.nominal, [side.axis.end for side in sides]
    reached = [side.axis.value(side.bracket[0]) for side in sides]
    width, tolerated = (sum(abs(x - nominal) for x in values) for values in (ends, reached))
    return {
        "nominal": nominal,
        "range": [min(nominal, *ends), max(nominal, *ends)],
        "tolerance": [min(nominal, *reached), max(nominal, *reached)],
        "share": tolerated / width,
        "sides": [side.to_json() for side in sides],
    }


class SensitivityTask(NamedTuple):
    """One episode; `axis` None: all is nominal."""

    task: str
    seed: int
    axis: Axis | None = None
    share: float = 0.0


@dataclass
class SensitivityWorker(StudyWorker[SensitivityTask, bool]):
    """Tries whether an actor succeeds; keeps the demonstrations that it replays."""

    search: SearchSpec

    def __post_init__(self) -> None:
        super().__post_init__()
        self._session = PolicySession(self.search.policy)
        self._demonstrations: dict[tuple[str, int], Attempt] = {}

    def finish(self) -> None:
        self._session.close()

    def do(self, job: SensitivityTask) -> bool:
        """A policy's crash is its failure. Raises `PolicyGone`: it is not there."""
        task, spec, axis = self.tasks[job.task], EpisodeSpec(job.task, NOMINAL), job.axis
        overrides = dict[str, Value]()
        try:
            if axis is not None:
                drawn: Vector = ()
                if axis.vector:
                    alone = EpisodeSpec(job.task, only=(axis.key,)).at(job.seed)
                    value = prepare(alone, task, self.pack).physics[axis.key]
                    assert isinstance(value, tuple)
                    drawn = value
                overrides = axis.overrides(job.share, drawn)
            recipe = replace(spec, overrides=overrides).at(job.seed)
            if self.search.policy == EXPERT:
                return self.demonstrate(recipe).accepted
            if self.search.policy == DEMONSTRATION:
                key = job.task, job.seed
                if key not in self._demonstrations:
                    tried = self.demonstrate(spec.at(job.seed))
                    self._demonstrations[key] = replace(tried, instance=None)  # worlds are large
                return bool(self.replay(recipe, self._demonstrations[key]))
            setup = PolicySetup(job.task, NOMINAL, spec.split, options=self.search.options)
            policy = self._session.policy(setup)
            episode = begin(recipe, task, self.pack, keep="nothing")
        except Infeasible:
            return False
        try:
            policy.play(episode)
        except (PolicyGone, KeyboardInterrupt):
            raise
        except BaseException as error:
            what = shortened(one_line(error))
            print(f"{job.task}, seed {job.seed}: the policy fails by {what}", flush=True)
            with suppress(PolicyBroken):
                self._session.close()  # what it remembers now must not decide the next episode
            return False
        return episode.success


@checked_dataclass(frozen=True)
class TaskSpec:
    """What decides the answers of one task: the first line of its ledger."""

    task: str
    search: SearchSpec
    fingerprint: Mapping[str, Any]  # of task, domain, assets and code
    policy_files: str = ""  # digest over the files that the policy's name leads to


@dataclass(frozen=True)
class SensitivityRow:
    """Whether the actor succeeded in one episode: a row of a ledger."""

    axis: str  # name; `NOMINAL` of the search for paired seeds
    share: float
    seed: int
    success: bool


class TaskSensitivity:
    """The bisections of one task, and the outcomes known so far, earlier runs' included.

    Raises `DatasetMismatch`: the folder holds outcomes of another search, or of other files of the
    policy.
    """

    def __init__(self, plan: SensitivityPlan, spec: TaskSpec) -> None:
        self.spec, self.search = spec, spec.search
        self.seeds: list[int] = []  # paired: the actor succeeds nominally
        self.outcomes: dict[tuple[str, float, int], bool] = {}
        self.path = plan.out / f"{spec.task}.json"
        self._ledger = self._open_ledger()
        domain, has = domain_for_task(spec.task), parts(first_props(load_task(spec.task)))
        sides = {
            key: axes(domain, key) if key in domain.rules else []
            for key in self.search.only or domain.keys
        }
        fixed = f"domain {domain.name} does not vary it"
        why = {
            key: why_idle(key, domain.keys, has) if found else fixed for key, found in sides.items()
        }
        self.idle = {key: clause for key, clause in why.items() if clause}  # with the reason
        self.sides = {
            key: [Bisection(axis, self.search.steps) for axis in found]
            for key, found in sides.items()
            if key not in self.idle
        }

    def _open_ledger(self) -> Ledger[TaskSpec, SensitivityRow]:
        path = self.path.with_suffix(".jsonl")
        try:
            return Ledger(path, self.spec, SensitivityRow, self._restore)
        except DatasetMismatch as error:  # where only the files differ, their digests say little
            before = read_header(TaskSpec, path)
            if replace(before, policy_files=self.spec.policy_files) != self.spec:
                raise
            clauses = edited(before.policy_files, self.spec.policy_files)
            raise DatasetMismatch(self.path.parent, clauses) from error

    def _restore(self, row: SensitivityRow) -> None:
        self.outcomes[row.axis, row.share, row.seed] = row.success

    def keep(self, row: SensitivityRow) -> None:
        """Adds an outcome to the ledger, unless it is there."""
        if (row.axis, row.share, row.seed) not in self.outcomes:
            self._restore(row)
            self._ledger.append(row)

    def rounds(self) -> Iterator[list["LevelSeries"]]:
        """What can be tried at once: the paired seeds, then one level of every open axis."""
        yield [LevelSeries(self)]
        if not self.seeds:
            return
        every = [bisection for of in self.sides.values() for bisection in of]
        while trials := [LevelSeries(self, b, b.next) for b in every if b.next is not None]:
            yield trials

    def write(self) -> dict[str, JSON]:
        """Writes the answers and returns them. Raises `CannotWrite`."""
        sides = self.sides if self.seeds else {}
        answers: dict[str, JSON] = {key: answer(of) for key, of in sides.items()}
        head: dict[str, JSON] = {"format": FORMAT, **stored(self.spec)}
        result = {**head, "seeds": [*self.seeds], "attributes": answers}
        files.replace_file(self.path, pretty(result))
        return result


class LevelSeries(Series[SensitivityTask, bool]):
    """One level of one axis on the paired seeds; without a bisection, the search for these."""

    def __init__(
        self, task: TaskSensitivity, bisection: Bisection | None = None, share: float = 0.0
    ) -> None:
        self.task, self.share, self.name = task, share, NOMINAL
        self.axis, self.level = None, None
        first, count = task.search.first_seed, task.search.seeds
        seeds: Sequence[int] = range(first, first + MAX_ATTEMPTS * count)
        if bisection:
            self.axis, self.name = bisection.axis, bisection.axis.name
            bisection.levels.append(level := Level(share))
            self.level, seeds, count = level, task.seeds, len(task.seeds)
        super().__init__(Progress(f"{task.spec.task}, {self.name}", count), seeds)

    def job(self, seed: int) -> SensitivityTask:
        return SensitivityTask(self.task.spec.task, seed, self.axis, self.share)

    def known(self, seed: int) -> bool | None:
        return self.task.outcomes.get((self.name, self.share, seed))

    def reason(self, result: bool) -> str:
        return "" if self.level or result else "failed"

    def commit(self, seed: int, result: bool) -> str:
        self.task.keep(SensitivityRow(self.name, self.share, seed, result))
        if self.level:
            self.level.of += 1
            self.level.successes += result
        elif result:
            self.task.seeds.append(seed)
        return ""

    def lost(self, seed: int, loss: WorkerFailure) -> bool:
        return False


def sensitivity(
    plan: SensitivityPlan, pack: Pack, listener: Listener = QUIET
) -> list[Mapping[str, JSON]]:
    """Measures every task of the plan, except for what earlier runs did; returns all results.

    What is written depends on the plan alone, not on the number of workers, nor on how often the
    run was killed and resumed. Raises `RtphysError`: outcomes of another search in the folder; a
    policy that cannot be reached; an error in a worker.
    """
    policy, digest = plan.search.policy, files_digest(plan.search.policy, plan.search.options)
    files.make_folder(plan.out)
    with FolderLock(plan.out):
        tasks: list[TaskSensitivity] = []
        for name in plan.tasks:
            check_task(policy, loaded := load_task(name), (NOMINAL,))
            ground = fingerprint_of(loaded, "phys_random", pack).to_json()
            tasks.append(one := TaskSensitivity(plan, TaskSpec(name, plan.search, ground, digest)))
            for key in plan.search.only or ():
                if why := one.idle.get(key):
                    listener.noticed(f"{key} could not act in {name}: {why}")
        results: list[Mapping[str, JSON]] = []
        listener.started([progress := Progress("tasks", len(tasks))])
        worker, size = SensitivityWorker(pack, plan.search), plan.workers or cores()
        with LocalPool(worker, size, limits_for_user_code(size, plan.timeout)) as pool:
            for task in tasks:  # one by one: its demonstrations stay in memory, its file is written
                for trials in task.rounds():
                    run_all(trials, pool, _WithinTask(listener), plan.out)
                results.append(task.write())
                progress.add("")
    return results


class _WithinTask(Listener):
    """Reports to another listener, but not the many short series that each task takes."""

    def __init__(self, listener: Listener) -> None:
        self.ticked, self.noticed = listener.ticked, listener.noticed
