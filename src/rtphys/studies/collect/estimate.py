"""Time and disk of a collection: a few attempts and one drawn episode of each task, scaled up."""

import tempfile
import time
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path

from rtphys.campaign.engine import Listener, run_all
from rtphys.campaign.series import Series, Study, Tally
from rtphys.campaign.workers.local import LocalPool, cores
from rtphys.campaign.workers.pool import Lost
from rtphys.data.journal import read_journal
from rtphys.data.layout import JOURNAL
from rtphys.sim import renderer
from rtphys.studies.collect.plan import Run, TaskPlan, check, check_assets
from rtphys.studies.cost import Cost, Meter
from rtphys.studies.worker import StudyWorker

BATCH, MOST = 2, 8  # attempts; so many if none of the first is accepted
PRIOR = 2.0  # attempts' worth of belief that a task is accepted as often as all are
SIDE_BYTES = 15e3  # [bytes] an episode: phys_meta, journal, manifest; measured


@dataclass(frozen=True)
class Measured:
    """What one plan's probe found: the cost of each side, twins included, and of the start."""

    sides: tuple[Cost, ...]
    start_cpu: float  # [s] of the worker, before its first job; 0 for its later ones
    pace: float  # wall-clock seconds for a CPU-second

    @property
    def attempts(self) -> int:
        return self.sides[0].attempts.count

    @property
    def accepted(self) -> int:
        """Attempts that all sides accept, as far as it was looked for."""
        return min(side.accepted for side in self.sides)

    @property
    def attempt_cpu(self) -> float:
        """CPU-seconds of an attempt, of all sides together."""
        return sum(side.attempts.cpu_s()["sum"] for side in self.sides)

    @property
    def frames(self) -> float:
        """Frames of an episode, of all sides together; 0: none was drawn."""
        return sum(side.frames / max(side.pictures.count, 1) for side in self.sides)

    def per_frame(self, amount: str) -> float:
        """`cpu` [s] or `bytes` of a drawn frame; 0: none was drawn."""
        frames = sum(side.frames for side in self.sides)
        of = {"cpu": lambda s: s.pictures.cpu_total, "bytes": lambda s: s.bytes}[amount]
        return sum(of(side) for side in self.sides) / frames if frames else 0.0


@dataclass(frozen=True)
class Expected:
    """What one task dataset still takes, or the sum over several."""

    episodes: int  # still to be collected
    attempts: float
    cpu: float  # [s]
    bytes: float


@dataclass(frozen=True)
class Estimate:
    """What the plans still take; `rows` lacks those whose probe failed."""

    rows: Sequence[tuple[TaskPlan, Expected]]
    workers: int
    start_cpu: float  # [s] of one worker
    pace: float  # wall-clock seconds for a worker's CPU-second; above 1 on a busy machine

    @property
    def total(self) -> Expected:
        """Sum over all tasks, with the workers' start."""
        rows = [expected for _, expected in self.rows]
        return Expected(
            sum(row.episodes for row in rows),
            sum(row.attempts for row in rows),
            sum(row.cpu for row in rows) + self.workers * self.start_cpu,
            sum(row.bytes for row in rows),
        )

    @property
    def wall(self) -> float:
        """Wall-clock time [s]."""
        return self.total.cpu * self.pace / self.workers


def estimate(plans: Sequence[TaskPlan], measured: Mapping[int, Measured], run: Run) -> Estimate:
    """What the plans still take.

    A task's acceptance is drawn towards that of all, because a few attempts say little; a task
    without a success is taken to be drawn like the others.

    Args:
        measured: by the plan's number.
    """
    known = list(measured.values())
    pooled = (sum(m.accepted for m in known) + 1) / (sum(m.attempts for m in known) + 1)
    drawn = [m for m in known if m.frames]
    usual = [_mean([m.frames for m in drawn])]
    usual += [_mean([m.per_frame(amount) for m in drawn]) for amount in ("cpu", "bytes")]
    rows: list[tuple[TaskPlan, Expected]] = []
    for number, m in measured.items():
        plan = plans[number]
        own = m.frames, m.per_frame("cpu"), m.per_frame("bytes")
        frames, draw_cpu, size = own if m.frames else usual
        episodes = max(plan.episodes - episodes_there(run.out, plan), 0)
        attempts = episodes * (m.attempts + PRIOR) / (m.accepted + PRIOR * pooled)
        cpu = attempts * m.attempt_cpu + episodes * frames * draw_cpu
        rows.append(
            (plan, Expected(episodes, attempts, cpu, episodes * (frames * size + SIDE_BYTES)))
        )
    start = _mean([m.start_cpu for m in known if m.start_cpu])
    return Estimate(rows, run.size(), start, _mean([m.pace for m in known]) or 1.0)


def _mean(values: Sequence[float]) -> float:
    return sum(values) / len(values) if values else 0.0


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
    study = Probe(plans)
    tally = Tally("probe", len(plans))
    worker = ProbeWorker(pack, run.shader)
    with LocalPool[TaskPlan, Measured | None](worker, size, run.limits, listener.noticed) as pool:
        run_all([Series(study, tally, range(len(plans)))], pool, listener)
    return study.measured


@dataclass
class Probe(Study[TaskPlan, Measured | None]):
    """A job for each plan, numbered in the place of seeds."""

    plans: Sequence[TaskPlan]
    measured: dict[int, Measured] = field(default_factory=dict[int, Measured])

    def job(self, seed: int) -> TaskPlan:
        return self.plans[seed]

    def reason(self, result: Measured | None) -> str:
        return ""

    def commit(self, seed: int, result: Measured | None) -> str:
        if result is not None:
            self.measured[seed] = result
        return ""

    def lost(self, seed: int, loss: Lost) -> None:
        return None


@dataclass
class ProbeWorker(StudyWorker[TaskPlan, Measured]):
    """Measures what a worker of a collection does."""

    shader: str

    def start(self) -> None:
        renderer.configure(self.shader)
        renderer.hold_anchor()
        self._start_cpu = time.process_time()

    def do(self, job: TaskPlan) -> Measured:
        start_cpu, self._start_cpu = self._start_cpu, 0.0
        began = time.process_time(), time.perf_counter()
        with tempfile.TemporaryDirectory(prefix="rtphys-probe-") as scratch:
            meter = Meter(self.pack, Path(scratch), job.cameras, job.layout, self.tasks)
            costs = tuple(self._measure(meter, side) for side in job.sides)
        cpu, wall = time.process_time() - began[0], time.perf_counter() - began[1]
        return Measured(costs, start_cpu, wall / cpu)

    def _measure(self, meter: Meter, plan: TaskPlan) -> Cost:
        first = plan.first_seed
        meter.warm_up(plan.setting, first, pictures=True)
        cost = meter.cost(plan.setting, range(first, first + BATCH), pictures=1)
        if not cost.accepted:
            cost = meter.cost(plan.setting, range(first, first + MOST), pictures=1)
        return cost
