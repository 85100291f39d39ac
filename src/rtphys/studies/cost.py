"""What episodes cost on this machine, phase by phase."""

import tempfile
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from itertools import product
from pathlib import Path
from statistics import fmean

from rtphys.assets.pack import Pack
from rtphys.core.timing import PhaseTimer
from rtphys.data.staging import stage_episode
from rtphys.episode.assemble import assemble, with_pictures
from rtphys.episode.generate import Attempt, attempt
from rtphys.episode.render import StateTrajectory, render_frames
from rtphys.plan.kinematics import check_robot
from rtphys.sim import renderer
from rtphys.spec.recording import RecordingSpec
from rtphys.studies.requests import BenchPlan
from rtphys.studies.resources import mistakes_named
from rtphys.task.spec import load_task

ATTEMPT = ("build", "settle", "plan", "simulate")
"""Phases of an attempt; no pictures. What a step of the simulator brings with it is `simulate`."""
PICTURES = ("build", "render", "encode", "write")
"""Phases after it is accepted: the world built once more, to be drawn; drawing; both encoders,
which run beside the renderer; writing, syncing, re-reading."""


@dataclass
class Spent:
    """Time of `count` repetitions of the same work: of each phase, of the rest, and in all."""

    phases: tuple[str, ...]
    count: int = 0
    timer: PhaseTimer = field(default_factory=PhaseTimer)  # the rest is its phase "other"

    def cpu_s(self) -> dict[str, float]:
        """CPU-seconds of one repetition, by phase; they add up to "sum"."""
        return self.mean(self.timer.cpu_s)

    def mean(self, spent: Mapping[str, float]) -> dict[str, float]:
        """Of one repetition. In wall time, what ran beside another phase counts nothing."""
        n = max(self.count, 1)
        named = {phase: spent.get(phase, 0.0) / n for phase in self.phases}
        total = sum(spent.values()) / n
        return {**named, "other": total - sum(named.values()), "sum": total}


@dataclass
class Cost:
    """Cost of a spec's episodes."""

    task: str
    protocol: str
    attempts: Spent = field(default_factory=lambda: Spent(ATTEMPT))
    pictures: Spent = field(default_factory=lambda: Spent(PICTURES))
    accepted: int = 0
    images: int = 0
    bytes: int = 0  # on disk

    def to_json(self) -> dict[str, object]:
        return {
            "task": self.task,
            "protocol": self.protocol,
            "attempts": self.attempts.count,
            "accepted": self.accepted,
            "images": self.images,
            "attempt_cpu_s": self.attempts.cpu_s(),
            "attempt_wall_s": self.attempts.mean(self.attempts.timer.wall_s),
            "pictures_cpu_s": self.pictures.cpu_s(),
            "pictures_wall_s": self.pictures.mean(self.pictures.timer.wall_s),
            "episode_bytes": self.bytes / max(self.pictures.count, 1),
        }


def bench(plan: BenchPlan, pack: Pack, measured: Callable[[Cost], None]) -> list[Cost]:
    """Measures all tasks under all protocols in this process, one after the other.

    Args:
        measured: is given each result as soon as it is there.

    Raises `NoRenderer`: pictures are wanted and cannot be drawn.
    """
    check_robot(pack, plan.episode.embodiment)
    if plan.pictures:
        renderer.ready()
    costs: list[Cost] = []
    seeds = range(plan.first_seed, plan.first_seed + plan.episodes)
    with tempfile.TemporaryDirectory(prefix="rtphys-bench-") as scratch:
        for name, protocol in product(plan.tasks, plan.protocols):
            spec, task = replace(plan.episode, task=name, protocol=protocol), load_task(name)
            # Fills the caches that a process fills once.
            with mistakes_named(task):
                warm = attempt(spec.at(seeds.stop), task, pack)
            if plan.pictures and warm.recording is not None:
                states = StateTrajectory.of(warm.recording)
                render_frames(warm.recipe, task, pack, states, RecordingSpec())
            cost = Cost(name, protocol)
            for seed in seeds:
                with mistakes_named(task), (timer := cost.attempts.timer).phase("other"):
                    tried = attempt(spec.at(seed), task, pack, timer)
                cost.attempts.count += 1
                cost.accepted += tried.accepted
                if tried.accepted and plan.pictures:
                    with cost.pictures.timer.phase("other"):
                        _draw(tried, pack, Path(scratch), cost)
            costs.append(cost)
            measured(cost)
    return costs


def _draw(tried: Attempt, pack: Pack, folder: Path, cost: Cost) -> None:
    assert tried.recording is not None and tried.instance is not None
    recording = RecordingSpec()
    with (timer := cost.pictures.timer).phase("build"):
        states = StateTrajectory.of(tried.recording)
        taken = render_frames(tried.recipe, tried.instance.task, pack, states, recording)
        episode = with_pictures(assemble(tried, pack), taken)
    staged = stage_episode(folder / "episode", episode, recording.layout, timer)
    cost.pictures.count += 1
    cost.images += staged.frames * len(recording.official)
    cost.bytes += sum(facts.size for facts in staged.files.values())


def means(costs: Sequence[Cost]) -> dict[str, dict[str, float]]:
    """Protocol -> means over its tasks: `attempt_cpu_s`."""
    spent: dict[str, list[float]] = {}
    for cost in costs:
        spent.setdefault(cost.protocol, []).append(cost.attempts.cpu_s()["sum"])
    return {protocol: {"attempt_cpu_s": fmean(each)} for protocol, each in spent.items()}
