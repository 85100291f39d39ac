"""Time and disk of a collection, from a probe; and how right that was."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

from rtphys.data.journal import read_journal
from rtphys.data.layout import JOURNAL
from rtphys.studies.collect.measure import Measured
from rtphys.studies.collect.plan import CollectPlan

FAITH = 2.0  # attempts' worth of belief that a task is accepted as often as all are
SIDE_BYTES = 15e3  # [bytes] an episode: phys_meta, journal, manifest; measured


@dataclass(frozen=True)
class Cost:
    """Of one task, or of all."""

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


NOTHING = Cost(0, 0.0, 0.0, 0.0)


@dataclass(frozen=True)
class Estimate:
    """Of one plan. `tasks` lacks those whose probe failed."""

    tasks: Mapping[str, Cost]
    workers: int
    start_cpu: float  # [s] of one worker
    pace: float  # wall-clock seconds for a worker's CPU-second; above 1 on a busy machine

    @property
    def total(self) -> Cost:
        """With the workers' start."""
        return sum(self.tasks.values(), Cost(0, 0.0, self.workers * self.start_cpu, 0.0))

    @property
    def wall(self) -> float:
        """[s]"""
        return self.total.cpu * self.pace / self.workers


def estimate(plan: CollectPlan, measured: Mapping[str, Measured], workers: int) -> Estimate:
    """What `plan` still costs.

    A task's acceptance is drawn towards that of all, because a few attempts say little; a task
    without a success is taken to be drawn like the others.
    """
    known = list(measured.values())
    tried, won = sum(m.attempts for m in known), sum(m.accepted for m in known)
    pooled = (won + 1) / (tried + 1)
    drawn = [m for m in known if m.draw_cpu] or known
    frames, draw_cpu, size = (_mean(drawn, key) for key in ("frames", "draw_cpu", "bytes"))
    costs = {}
    for name, m in measured.items():
        rate = (m.accepted + FAITH * pooled) / (m.attempts + FAITH)
        length = m.frames or frames
        episodes = max(plan.share - episodes_there(plan, name), 0)
        attempts = episodes / rate
        cpu = attempts * m.attempt_cpu + episodes * length * (m.draw_cpu or draw_cpu)
        costs[name] = Cost(
            episodes, attempts, cpu, episodes * (length * (m.bytes or size) + SIDE_BYTES)
        )
    starts = [m.start_cpu for m in known if m.start_cpu]
    cpu, wall = sum(m.cpu for m in known), sum(m.wall for m in known)
    start = sum(starts) / len(starts) if starts else 0.0
    return Estimate(costs, workers, start, wall / cpu if cpu else 1.0)


def _mean(measured: Sequence[Measured], key: str) -> float:
    return sum(getattr(m, key) for m in measured) / len(measured) if measured else 0.0


def episodes_there(plan: CollectPlan, task: str) -> int:
    """Of earlier runs, in the folder. Raises `BadFile`."""
    path = plan.out / plan.leaf_name(task) / JOURNAL
    if not path.exists():
        return 0
    return sum(line.entry.get("verdict") == "accepted" for line in read_journal(path).lines)


def bytes_below(out: Path) -> int:
    """All files of a dataset."""
    return sum(path.stat().st_size for path in out.rglob("*") if path.is_file())
