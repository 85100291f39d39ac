"""What an episode costs on this machine, phase by phase."""

import tempfile
import time
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field
from pathlib import Path

from rtphys.assets.pack import Pack
from rtphys.core.errors import BadValue
from rtphys.core.timing import PhaseTimer
from rtphys.data.staging import stage_episode
from rtphys.episode.assemble import assemble
from rtphys.episode.generate import Attempt, attempt
from rtphys.episode.photograph import photograph
from rtphys.setting.protocol import load_protocol
from rtphys.setting.recipe import Recipe
from rtphys.sim import renderer
from rtphys.task.spec import Task, load_task

ATTEMPT = ("build", "settle", "plan", "simulate")
"""Phases of an attempt; no pictures. What a step of the simulator brings with it is `simulate`."""
PICTURES = ("build", "render", "encode", "write")
"""Phases after it is accepted: the world built once more, to be drawn; drawing; both encoders,
which run beside the renderer; writing, syncing, re-reading."""
OUTSIDE = ("build", "write", "other")  # neither physics nor planning, nor rendering, nor encoding
CAMERAS = ("head", "left", "right")


@dataclass(frozen=True)
class BenchPlan:
    """One run of `bench`."""

    tasks: tuple[str, ...]
    protocols: tuple[str, ...] = ("clean", "phys_random_all")
    episodes: int = 2  # attempts of each task under each protocol
    first_seed: int = 0
    pictures: bool = True  # draw and write what is accepted

    def check(self) -> None:
        """Raises UnknownName, BadValue or BadFile before any work is done."""
        for name in self.tasks:
            load_task(name)
        for name in self.protocols:
            load_protocol(name)
        for key, least in (("episodes", 1), ("first_seed", 0)):
            if getattr(self, key) < least:
                raise BadValue(f"--{key.replace('_', '-')}", getattr(self, key), f">= {least}")


@dataclass
class Spent:
    """Time of `count` repetitions of the same work: of each phase, of the rest, and in all."""

    phases: tuple[str, ...]
    count: int = 0
    timer: PhaseTimer = field(default_factory=PhaseTimer)
    cpu_total: float = 0.0  # [s]
    wall_total: float = 0.0  # [s]

    @contextmanager
    def once(self) -> Iterator[PhaseTimer]:
        """Within: the work is done once, with its phases counted by the timer given."""
        began = time.process_time(), time.perf_counter()
        yield self.timer
        self.cpu_total += time.process_time() - began[0]
        self.wall_total += time.perf_counter() - began[1]
        self.count += 1

    def cpu_s(self) -> dict[str, float]:
        """CPU-seconds of one repetition, by phase; they add up to "sum"."""
        return self._mean(self.timer.cpu_s, self.cpu_total)

    def wall_s(self) -> dict[str, float]:
        """Wall-seconds likewise. What ran beside another phase counts nothing."""
        return self._mean(self.timer.wall_s, self.wall_total)

    def _mean(self, spent: Mapping[str, float], total: float) -> dict[str, float]:
        n = max(self.count, 1)
        named = {phase: spent.get(phase, 0.0) / n for phase in self.phases}
        return {**named, "other": total / n - sum(named.values()), "sum": total / n}


@dataclass
class Cost:
    """One task under one protocol."""

    task: str
    protocol: str
    attempts: Spent = field(default_factory=lambda: Spent(ATTEMPT))
    pictures: Spent = field(default_factory=lambda: Spent(PICTURES))
    accepted: int = 0
    images: int = 0

    @property
    def image_cpu_ms(self) -> float | None:
        """CPU-milliseconds a saved image, rejected attempts included; None without images."""
        if not self.images:
            return None
        return 1e3 * (self.attempts.cpu_total + self.pictures.cpu_total) / self.images

    @property
    def outside(self) -> float:
        """Share of CPU time spent neither on physics, planning, rendering nor encoding."""
        both = (self.attempts, self.pictures)
        spent = sum(s.count * sum(s.cpu_s().get(phase, 0.0) for phase in OUTSIDE) for s in both)
        return spent / max(sum(s.cpu_total for s in both), 1e-9)

    def to_json(self) -> dict[str, object]:
        return {
            "task": self.task,
            "protocol": self.protocol,
            "attempts": self.attempts.count,
            "accepted": self.accepted,
            "images": self.images,
            "attempt_cpu_s": self.attempts.cpu_s(),
            "attempt_wall_s": self.attempts.wall_s(),
            "pictures_cpu_s": self.pictures.cpu_s(),
            "pictures_wall_s": self.pictures.wall_s(),
            "image_cpu_ms": self.image_cpu_ms,
            "outside": self.outside,
        }


def bench(plan: BenchPlan, pack: Pack, told: Callable[[Cost], None]) -> list[Cost]:
    """Measure all tasks under all protocols in this process, one after the other.

    An attempt before the first, and the world that its pictures need, are not counted: they fill
    caches that a process fills once.

    Args:
        told: is given each result as it is there.

    Raises:
        NoRenderer: pictures are wanted and cannot be drawn.
    """
    if plan.pictures:
        renderer.configure()
        renderer.hold_anchor()
    costs = []
    with tempfile.TemporaryDirectory(prefix="rtphys-bench-") as scratch:
        for name in plan.tasks:
            task = load_task(name)
            for protocol in plan.protocols:
                job = _Job(plan, task, pack, Path(scratch) / "episode")
                costs.append(job.cost(protocol))
                told(costs[-1])
    return costs


@dataclass(frozen=True)
class _Job:
    plan: BenchPlan
    task: Task
    pack: Pack
    folder: Path

    def cost(self, protocol: str) -> Cost:
        cost = Cost(self.task.name, protocol)
        self._warm_up(protocol)
        for seed in range(self.plan.first_seed, self.plan.first_seed + self.plan.episodes):
            with cost.attempts.once() as timer:
                tried = attempt(Recipe(self.task.name, seed, protocol), self.task, self.pack, timer)
            cost.accepted += tried.accepted
            if tried.accepted and self.plan.pictures:
                with cost.pictures.once() as timer:
                    cost.images += self._draw(tried, timer)
        return cost

    def _warm_up(self, protocol: str) -> None:
        seed = self.plan.first_seed + self.plan.episodes
        tried = attempt(Recipe(self.task.name, seed, protocol), self.task, self.pack)
        if self.plan.pictures and tried.recording is not None:
            photograph(tried.recipe, self.task, self.pack, tried.recording, CAMERAS)

    def _draw(self, tried: Attempt, timer: PhaseTimer) -> int:
        """Number of images that a dataset would hold of it."""
        assert tried.recording is not None
        with timer.phase("build"):
            taken = photograph(tried.recipe, self.task, self.pack, tried.recording, CAMERAS)
            episode = assemble(tried, taken, self.pack)
        return stage_episode(self.folder, episode, timer=timer).frames * len(CAMERAS)


def means(costs: Sequence[Cost]) -> dict[str, dict[str, float]]:
    """Protocol -> mean over its tasks of what is held to a bar.

    Keys: `attempt_cpu_s`, `outside`, and `image_cpu_ms` if anything was drawn.
    """
    found: dict[str, dict[str, float]] = {}
    for protocol in dict.fromkeys(cost.protocol for cost in costs):
        rows = [cost for cost in costs if cost.protocol == protocol]
        attempts = [row.attempts.cpu_s()["sum"] for row in rows]
        images = [ms for row in rows if (ms := row.image_cpu_ms) is not None]
        found[protocol] = {
            "attempt_cpu_s": sum(attempts) / len(attempts),
            "outside": sum(row.outside for row in rows) / len(rows),
        }
        if images:
            found[protocol]["image_cpu_ms"] = sum(images) / len(images)
    return found
