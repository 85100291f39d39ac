"""Time and disk of a collection: a few attempts and one drawn episode of each task, scaled up."""

import tempfile
import time
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

from rtphys.campaign.engine import Listener, run_all
from rtphys.campaign.series import Series, Study, Tally
from rtphys.campaign.workers.local import LocalPool, cores
from rtphys.campaign.workers.pool import Lost
from rtphys.data.journal import read_journal
from rtphys.data.layout import JOURNAL
from rtphys.data.staging import StagedEpisode
from rtphys.episode.generate import Attempt
from rtphys.studies.collect.plan import Run, TaskPlan, check, check_assets
from rtphys.studies.collect.work import CollectWorker, Job
from rtphys.studies.worker import StudyWorker

FEWEST = 3  # attempts, of which the first warms up what a run warms up once
MOST = 8  # attempts to find one that can be drawn
PRIOR = 2.0  # attempts' worth of belief that a task is accepted as often as all are
SIDE_BYTES = 15e3  # [bytes] an episode: phys_meta, journal, manifest; measured


@dataclass(frozen=True)
class Measured:
    """What one task cost. CPU-seconds are of the worker; a job of twins counts as one attempt."""

    attempts: int
    accepted: int
    attempt_cpu: float  # [s] mean of those after the first
    frames: float  # mean of an accepted attempt; 0: none was
    draw_cpu: float  # [s] a frame: draw, encode, write, read again; 0: none was drawn
    bytes: float  # a frame, on disk
    start_cpu: float  # [s] of the worker, before its first job; 0 for its later ones
    cpu: float  # [s] of the whole job
    wall: float  # [s] likewise


@dataclass(frozen=True)
class Cost:
    """Cost of one task dataset, or the sum over several."""

    episodes: int  # still to be collected
    attempts: float
    cpu: float  # [s]
    bytes: float

    def __add__(self, other: "Cost") -> "Cost":
        return Cost(
            self.episodes + other.episodes,
            self.attempts + other.attempts,
            self.cpu + other.cpu,
            self.bytes + other.bytes,
        )


@dataclass(frozen=True)
class Estimate:
    """What the plans still cost; `costs` lacks those whose probe failed."""

    costs: Sequence[tuple[TaskPlan, Cost]]
    workers: int
    start_cpu: float  # [s] of one worker
    pace: float  # wall-clock seconds for a worker's CPU-second; above 1 on a busy machine

    @property
    def total(self) -> Cost:
        """Sum over all tasks, with the workers' start."""
        start = Cost(0, 0.0, self.workers * self.start_cpu, 0.0)
        return sum((cost for _, cost in self.costs), start)

    @property
    def wall(self) -> float:
        """Wall-clock time [s]."""
        return self.total.cpu * self.pace / self.workers


def estimate(plans: Sequence[TaskPlan], measured: Mapping[int, Measured], run: Run) -> Estimate:
    """What the plans still cost.

    A task's acceptance is drawn towards that of all, because a few attempts say little; a task
    without a success is taken to be drawn like the others.

    Args:
        measured: by the plan's number.
    """
    known = list(measured.values())
    tried, won = sum(m.attempts for m in known), sum(m.accepted for m in known)
    pooled = (won + 1) / (tried + 1)
    drawn = [m for m in known if m.draw_cpu] or known
    frames, draw_cpu, size = (_mean(drawn, key) for key in ("frames", "draw_cpu", "bytes"))
    costs: list[tuple[TaskPlan, Cost]] = []
    for number, m in measured.items():
        plan = plans[number]
        rate = (m.accepted + PRIOR * pooled) / (m.attempts + PRIOR)
        length = m.frames or frames
        episodes = max(plan.episodes - episodes_there(run.out, plan), 0)
        attempts = episodes / rate
        cpu = attempts * m.attempt_cpu + episodes * length * (m.draw_cpu or draw_cpu)
        size_each = length * (m.bytes or size) + SIDE_BYTES
        costs.append((plan, Cost(episodes, attempts, cpu, episodes * size_each)))
    starts = [m.start_cpu for m in known if m.start_cpu]
    cpu, wall = sum(m.cpu for m in known), sum(m.wall for m in known)
    start = sum(starts) / len(starts) if starts else 0.0
    return Estimate(costs, run.size(), start, wall / cpu if cpu else 1.0)


def _mean(measured: Sequence[Measured], key: str) -> float:
    return sum(getattr(m, key) for m in measured) / len(measured) if measured else 0.0


def episodes_there(out: Path, plan: TaskPlan) -> int:
    """Episodes that earlier runs have left in the folder. Raises `BadFile`."""
    path = out / plan.folder / JOURNAL
    if not path.exists():
        return 0
    return sum(line.entry.get("verdict") == "accepted" for line in read_journal(path).lines)


def bytes_below(out: Path) -> int:
    """Size of all files of a dataset [bytes]."""
    return sum(path.stat().st_size for path in out.rglob("*") if path.is_file())


def probe(
    plans: Sequence[TaskPlan], run: Run, listener: Listener | None = None
) -> dict[int, Measured]:
    """Number of a plan -> what it costs on this machine. Writes nothing that stays.

    Raises:
        RtphysError: what `check` refuses.
        Bug: an unexpected exception in a worker.
    """
    listener = listener or Listener()
    check(plans, run)
    pack = run.pack(listener.building)
    check_assets(plans, pack)
    size = cores() if run.workers is None else min(run.workers, cores())
    probes = [Probe(plan) for plan in plans]
    series = [
        Series(one, Tally(one.plan.setting.task, 1), (one.plan.first_seed,)) for one in probes
    ]
    worker = ProbeWorker(pack, CollectWorker(pack, run.shader))
    with LocalPool[Job, Measured | None](worker, size, run.limits, listener.noticed) as pool:
        run_all(series, pool, listener)
    return {n: one.measured for n, one in enumerate(probes) if one.measured}


@dataclass
class Probe(Study[Job, Measured | None]):
    """One plan's probe: a single job, which tries several seeds."""

    plan: TaskPlan
    measured: Measured | None = None

    def job(self, seed: int) -> Job:
        recipes = tuple(side.setting.at(seed) for side in self.plan.sides)
        return Job(recipes, (), self.plan.cameras, self.plan.layout)

    def reason(self, result: Measured | None) -> str:
        return ""

    def commit(self, seed: int, result: Measured | None) -> str:
        self.measured = result
        return ""

    def lost(self, seed: int, loss: Lost) -> None:
        return None


@dataclass
class ProbeWorker(StudyWorker[Job, Measured]):
    """Measures what another worker does."""

    worker: CollectWorker

    def start(self) -> None:
        self.worker()
        self._start_cpu = time.process_time()

    def do(self, job: Job) -> Measured:
        clock, began = time.process_time, (time.process_time(), time.perf_counter())
        start_cpu, self._start_cpu = self._start_cpu, 0.0
        won: list[list[Attempt]] = []
        spent: list[float] = []
        for number in range(MOST):
            before = clock()
            recipes = tuple(replace(one, seed=one.seed + number) for one in job.recipes)
            attempts = self.worker.attempt(recipes)
            spent.append(clock() - before)
            won += [attempts] if all(one.accepted for one in attempts) else []
            if won and len(spent) >= FEWEST:
                break
        drawn = self._draw(won[0], job, warm=not start_cpu) if won else (0.0, 0.0)
        later = spent[1:] or spent
        lengths = [sum(_frames(one) for one in attempts) for attempts in won]
        return Measured(
            attempts=len(spent),
            accepted=len(won),
            attempt_cpu=sum(later) / len(later),
            frames=sum(lengths) / len(lengths) if lengths else 0.0,
            draw_cpu=drawn[0],
            bytes=drawn[1],
            start_cpu=start_cpu,
            cpu=clock() - began[0],
            wall=time.perf_counter() - began[1],
        )

    def _draw(self, attempts: list[Attempt], job: Job, warm: bool) -> tuple[float, float]:
        """CPU-seconds and bytes a frame."""
        with tempfile.TemporaryDirectory(prefix="rtphys-probe-") as folder:
            places = replace(
                job, folders=tuple(Path(folder) / str(n) for n in range(len(attempts)))
            )
            if not warm:  # the renderer's start is a worker's, not an episode's
                self.worker.stage(attempts[:1], replace(job, folders=(Path(folder) / "first",)))
            before = time.process_time()
            staged = self.worker.stage(attempts, places)
            spent = time.process_time() - before
        frames = sum(one.frames for one in staged)
        return spent / frames, sum(_size(one) for one in staged) / frames


def _frames(one: Attempt) -> int:
    return len(one.recording.rows) if one.recording else 0


def _size(staged: StagedEpisode) -> int:
    return sum(facts.size for facts in staged.files.values())
