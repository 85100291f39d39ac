"""A short look at what a collection costs: a few attempts and one drawn episode of each task."""

import tempfile
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path

from rtphys.assets.pack import chosen_pack
from rtphys.campaign.workers.local import Crew, cores
from rtphys.campaign.workers.pool import Done
from rtphys.data.staging import StagedEpisode
from rtphys.episode.generate import Attempt
from rtphys.setting.recipe import Recipe
from rtphys.studies.collect.plan import CollectPlan
from rtphys.studies.collect.run import Listener
from rtphys.studies.collect.tally import Tally
from rtphys.studies.collect.work import Desk

FEWEST = 3  # attempts, of which the first warms up what a run warms up once
MOST = 8  # attempts to find one that can be drawn


@dataclass(frozen=True)
class ProbeJob:
    """One task: the recipes of one seed after the other."""

    seeds: tuple[tuple[Recipe, ...], ...]


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
class ProbeDesk:
    """A worker that measures; set up like the one that works."""

    desk: Desk

    def __call__(self) -> Callable[[ProbeJob], Measured]:
        self.desk()
        spent = [time.process_time()]
        return lambda job: self._measure(job, spent)

    def _measure(self, job: ProbeJob, start: list[float]) -> Measured:
        clock, began = time.process_time, (time.process_time(), time.perf_counter())
        cold = start.pop() if start else 0.0
        won: list[list[Attempt]] = []
        spent: list[float] = []
        for recipes in job.seeds:
            before = clock()
            tried = self.desk.attempt(recipes)
            spent.append(clock() - before)
            won += [tried] if all(one.accepted for one in tried) else []
            if won and len(spent) >= FEWEST:
                break
        drawn = self._draw(won[0], warm=not cold) if won else (0.0, 0.0)
        later = spent[1:] or spent
        lengths = [sum(_frames(one) for one in tried) for tried in won]
        return Measured(
            attempts=len(spent),
            accepted=len(won),
            attempt_cpu=sum(later) / len(later),
            frames=sum(lengths) / len(lengths) if lengths else 0.0,
            draw_cpu=drawn[0],
            bytes=drawn[1],
            start_cpu=cold,
            cpu=clock() - began[0],
            wall=time.perf_counter() - began[1],
        )

    def _draw(self, tried: list[Attempt], warm: bool) -> tuple[float, float]:
        """CPU-seconds and bytes a frame."""
        with tempfile.TemporaryDirectory(prefix="rtphys-probe-") as folder:
            if not warm:  # the renderer's start is a worker's, not an episode's
                self.desk.stage(tried[0], Path(folder) / "first")
            before = time.process_time()
            staged = [self.desk.stage(one, Path(folder) / str(n)) for n, one in enumerate(tried)]
            spent = time.process_time() - before
        frames = sum(one.frames for one in staged)
        return spent / frames, sum(_size(one) for one in staged) / frames


def _frames(one: Attempt) -> int:
    return len(one.recording.rows) if one.recording else 0


def _size(staged: StagedEpisode) -> int:
    return sum(facts.size for facts in staged.files.values())


def probe(plan: CollectPlan, listener: Listener | None = None) -> dict[str, Measured]:
    """Task -> what it costs on this machine. Writes nothing that stays.

    Raises:
        RtphysError: what `CollectPlan.check` refuses.
        WorkerFailed: a bug.
    """
    told = listener or Listener()
    tasks = plan.check()
    pack = chosen_pack(plan.assets, plan.fallback, told.building)
    plan.check_assets(tasks, pack)
    size = cores() if plan.workers is None else min(plan.workers, cores())
    desk = ProbeDesk(Desk(pack, plan.cameras, plan.layout, plan.shader))
    waiting = [(name, _job(plan, name)) for name in plan.tasks]
    tallies = {name: Tally(name, 1) for name in plan.tasks}
    told.started(list(tallies.values()))
    found: dict[str, Measured] = {}
    with Crew[ProbeJob, Measured](desk, size, plan.limits, told.noticed) as crew:
        while waiting or crew.busy:
            while waiting and crew.room:
                crew.submit(*waiting.pop(0))
            for event in crew.wait():
                name = str(event.name)
                tallies[name].episodes = 1
                if isinstance(event, Done):
                    found[name] = event.result
            told.ticked()
    return found


def _job(plan: CollectPlan, task: str) -> ProbeJob:
    first, step = plan.stride
    seeds: Sequence[int] = [plan.first_seed + first + n * step for n in range(MOST)]
    return ProbeJob(tuple(plan.recipes(task, seed) for seed in seeds))
