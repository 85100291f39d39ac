"""What an author wants to know of a task: does the expert solve it, and does nobody else?"""

import time
from collections import Counter
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field, replace
from typing import Literal, NamedTuple

import numpy as np

from rtphys.assets.pack import Pack
from rtphys.campaign.workers.local import Crew
from rtphys.campaign.workers.pool import Limits, Lost
from rtphys.core.errors import BadValue, Infeasible
from rtphys.data.jpeg import encode_png
from rtphys.episode import begin
from rtphys.episode.generate import Attempt, attempt, start
from rtphys.episode.instance import prepare
from rtphys.episode.photograph import photograph
from rtphys.episode.replay import actions_of, replay
from rtphys.physics.domain import Domain
from rtphys.policies import open_policy
from rtphys.setting.protocol import load_protocol
from rtphys.setting.recipe import Recipe, check_varies
from rtphys.sim import renderer
from rtphys.task.spec import Task, load_task

ROBOTS = 20  # seeds on which the idle and the random robot are tried
AGAIN = 2  # seeds that the expert does twice, to compare the states
SHEET_CAMERAS = ("head", "left", "right", "front")

Kind = Literal["expert", "again", "idle", "random", "sheet"]


@dataclass(frozen=True)
class CheckPlan:
    """One run of `check`."""

    tasks: tuple[str, ...]
    protocols: tuple[str, ...] = ("clean",)
    seeds: int = 20
    first_seed: int = 0
    robots: int = ROBOTS
    workers: int = 1
    ranges: Domain | None = None  # drawn from instead of each task's own domain
    limits: Limits = field(default_factory=Limits)

    def check(self) -> None:
        """Raises UnknownName, BadValue or BadFile before any work is done."""
        for name in self.tasks:
            load_task(name)
        for name in self.protocols:
            load_protocol(name)
        if self.ranges is not None:
            check_varies(self.ranges, self.protocols)
        least = {"seeds": 1, "first_seed": 0, "robots": 0, "workers": 1}
        for key, bound in least.items():
            if getattr(self, key) < bound:
                raise BadValue(f"--{key.replace('_', '-')}", getattr(self, key), f">= {bound}")

    def drawn(self, protocol: str) -> str:
        """Name of the domain that takes the place of the tasks' own; empty for none."""
        if self.ranges is None or not load_protocol(protocol).physics:
            return ""
        return self.ranges.name

    def jobs(self) -> "Iterator[Job]":
        """Everything to be tried, task by task."""
        for task in self.tasks:
            for protocol in self.protocols:
                counts = {"expert": self.seeds, "again": min(AGAIN, self.seeds)}
                counts |= {"idle": self.robots, "random": self.robots}
                for kind, count in counts.items():
                    for seed in range(self.first_seed, self.first_seed + count):
                        yield Job(kind, task, protocol, seed)  # type: ignore[arg-type]


class Job(NamedTuple):
    """One robot on one episode."""

    kind: Kind
    task: str
    protocol: str
    seed: int

    def __str__(self) -> str:
        return f"{self.task}, {self.protocol}, seed {self.seed} ({self.kind})"


@dataclass(frozen=True)
class Trial:
    """What came of a job."""

    reason: str = ""  # of the expert: empty if accepted
    detail: str = ""
    success: bool = False  # of the idle or random robot; of the expert's actions, replayed
    cpu_seconds: float = 0.0  # of the expert's attempt alone
    hash: str = ""
    picture: bytes = b""  # PNG, of a sheet


@dataclass
class Score:
    """One task under one protocol."""

    task: str
    protocol: str
    seeds: int
    accepted: int = 0
    rejected: Counter[str] = field(default_factory=Counter)
    failures: list[tuple[int, str, str]] = field(default_factory=list)  # seed, reason, detail
    solved: Counter[str] = field(default_factory=Counter)  # by kind
    tried: Counter[str] = field(default_factory=Counter)
    cpu: list[float] = field(default_factory=list)
    hashes: dict[int, set[str]] = field(default_factory=dict)
    good_seed: int | None = None  # the lowest accepted
    domain: str = ""  # name of one that was drawn from instead of the task's own

    def add(self, job: Job, trial: Trial) -> None:
        """Counts one trial; the order in which they come does not matter."""
        self.tried[job.kind] += 1
        if job.kind in ("expert", "again") and trial.hash:
            self.hashes.setdefault(job.seed, set()).add(trial.hash)
        if job.kind in ("idle", "random"):
            self.solved[job.kind] += trial.success
        if job.kind == "expert":
            self._add_expert(job.seed, trial)

    def _add_expert(self, seed: int, trial: Trial) -> None:
        self.cpu.append(trial.cpu_seconds)
        if trial.reason:
            self.rejected[trial.reason] += 1
            self.failures.append((seed, trial.reason, trial.detail))
            return
        self.accepted += 1
        self.solved["expert"] += trial.success
        self.good_seed = seed if self.good_seed is None else min(seed, self.good_seed)

    @property
    def deterministic(self) -> bool:
        """Whether each seed that was tried twice went through the same states."""
        return all(len(found) == 1 for found in self.hashes.values())

    def rate(self, kind: str) -> float | None:
        """Share of successes of a robot, None if it was not tried."""
        tried = self.accepted if kind == "expert" else self.tried[kind]
        return self.solved[kind] / tried if tried else None

    def to_json(self) -> dict[str, object]:
        """Rates are in [0, 1], or null where nothing was tried."""
        return {
            "task": self.task,
            "protocol": self.protocol,
            "seeds": self.seeds,
            "accepted": self.accepted,
            "rejected": dict(sorted(self.rejected.items())),
            "replay_success": self.rate("expert"),
            "idle_success": self.rate("idle"),
            "random_success": self.rate("random"),
            "cpu_seconds_mean": float(np.mean(self.cpu)) if self.cpu else None,
            **({"domain": self.domain} if self.domain else {}),
        }


def check(
    plan: CheckPlan, pack: Pack, told: Callable[[list[Score], int], None] = lambda *_: None
) -> list[Score]:
    """Tries the expert, its actions replayed, an idle robot and one that moves at random.

    Args:
        told: called with the scores so far and the number of jobs that are left.

    Raises:
        RtphysError: what `CheckPlan.check` refuses, or an exception in a worker.
    """
    plan.check()
    scores = {
        (task, protocol): Score(task, protocol, plan.seeds, domain=plan.drawn(protocol))
        for task in plan.tasks
        for protocol in plan.protocols
    }
    jobs = list(plan.jobs())
    for done, (job, trial) in enumerate(_tried(plan, pack, jobs), start=1):
        scores[job.task, job.protocol].add(job, trial)
        told(list(scores.values()), len(jobs) - done)
    for score in scores.values():
        score.failures.sort()
    return list(scores.values())


def sheet(plan: CheckPlan, pack: Pack, score: Score) -> tuple[int, bytes]:
    """(seed, PNG): one row a camera, one column the end of each stage.

    Shows the lowest accepted seed, or the first failure if there is none. Needs a renderer.
    """
    seed = score.failures[0][0] if score.good_seed is None else score.good_seed
    job = Job("sheet", score.task, score.protocol, seed)
    _, trial = next(_tried(replace(plan, workers=1), pack, [job]))
    return seed, trial.picture


def _tried(plan: CheckPlan, pack: Pack, jobs: Sequence[Job]) -> Iterator[tuple[Job, Trial]]:
    waiting = list(reversed(jobs))
    with Crew[Job, Trial](Bench(pack, plan.ranges), plan.workers, plan.limits) as crew:
        while waiting or crew.busy:
            while waiting and crew.room:
                job = waiting.pop()
                crew.submit(job, job)
            for event in crew.wait():
                assert isinstance(event.name, Job)
                lost = isinstance(event, Lost)
                yield event.name, Trial(event.reason, event.detail) if lost else event.result


# ---- in a worker -------------------------------------------------------------------------------


@dataclass(frozen=True)
class Bench:
    """A worker's equipment: picklable, set up once in each process by calling it."""

    pack: Pack
    ranges: Domain | None = None

    def __call__(self) -> Callable[[Job], Trial]:
        return self.do

    def _recipe(self, job: Job) -> Recipe:
        return Recipe(job.task, job.seed, job.protocol, ranges=self.ranges)

    def do(self, job: Job) -> Trial:
        recipe, task = self._recipe(job), load_task(job.task)
        if job.kind in ("idle", "random"):
            return Trial(success=solves(recipe, task, self.pack, job.kind))
        if job.kind == "sheet":
            renderer.configure()  # before the first scene
        began = time.process_time()
        tried = attempt(recipe, task, self.pack)
        spent = time.process_time() - began
        if job.kind == "sheet":
            return Trial(picture=_picture(recipe, task, self.pack, tried))
        found = tried.recording
        again = False
        if job.kind == "expert" and tried.accepted and found is not None:
            again = replay(recipe, task, self.pack, actions_of(found))
        state = found.hash if found is not None else ""
        return Trial(tried.reason, tried.detail, again, spent, state)


def solves(recipe: Recipe, task: Task, pack: Pack, robot: str) -> bool:
    """Whether a robot that sees nothing solves an episode within the task's step limit."""
    try:
        episode = begin(recipe, task, pack)
    except Infeasible:
        return False
    open_policy(robot).play(episode)
    return episode.success


def _picture(recipe: Recipe, task: Task, pack: Pack, tried: Attempt) -> bytes:
    if tried.recording is None:  # not even settled: show what it looks like before anyone acts
        rollout = start(prepare(recipe, task, pack))
        recording = rollout.recorder.recording
    else:
        recording = tried.recording
    last = {row.stage: row for row in recording.rows}  # of each stage
    ends = replace(recording, rows=list(last.values()))
    images = photograph(recipe, task, pack, ends, SHEET_CAMERAS).images
    columns = [np.concatenate(list(shown.values())) for shown in images]
    return encode_png(np.concatenate(columns, axis=1))
