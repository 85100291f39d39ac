"""What an author wants to know of a task: does the expert solve it, and does nobody else?"""

import time
from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from typing import Annotated, Literal, NamedTuple

import numpy as np

from rtphys.assets.pack import Pack
from rtphys.campaign.engine import Listener, run_all
from rtphys.campaign.series import Series, Study, Tally
from rtphys.campaign.workers.local import LocalPool, cores
from rtphys.campaign.workers.pool import Limits, Lost
from rtphys.core.errors import Infeasible
from rtphys.data.jpeg import encode_png
from rtphys.episode import begin
from rtphys.episode.generate import Attempt, attempt, start
from rtphys.episode.instance import prepare
from rtphys.episode.photograph import photograph
from rtphys.episode.replay import actions_of, replay
from rtphys.policies import open_policy
from rtphys.setting.option import (
    Option,
    Positive,
    Protocols,
    Seed,
    Tasks,
    Workers,
    checked_dataclass,
)
from rtphys.setting.protocol import load_protocol
from rtphys.setting.setting import Ranges, Recipe, Setting, check_varies
from rtphys.sim import renderer
from rtphys.studies.worker import StudyWorker
from rtphys.task.spec import Task, load_task

TWICE = 2  # seeds that the expert does twice, to compare the states
SHEET_CAMERAS = ("head", "left", "right", "front")

Robot = Literal["expert", "again", "idle", "random", "jitter", "sheet"]
BLIND: tuple[Robot, ...] = ("idle", "random", "jitter")  # they see nothing, and must fail


@checked_dataclass(frozen=True)
class CheckPlan:
    """One run of `check`: tasks under protocols."""

    tasks: Annotated[Tasks, Option("Tasks or patterns.", positional=True)]
    protocols: Protocols = ("clean",)
    seeds: Annotated[Positive, Option("Number of seeds of each task and protocol.")] = 20
    first_seed: Annotated[Seed, Option("The first seed.")] = 0
    robots: Annotated[
        Seed, Option("Number of seeds for the robots that see nothing, which cost the most.")
    ] = 20
    workers: Workers = None
    ranges: Annotated[
        Ranges, Option("Draw from this domain (name or file), not from the task's own.", "domain")
    ] = None
    limits: Limits = field(default_factory=Limits)

    def check(self) -> None:
        """Raises `BadValue` or `BadFile` before any work is done."""
        for name in self.tasks:
            load_task(name)
        if self.ranges is not None:
            check_varies(self.ranges, self.protocols)

    def settings(self) -> list[Setting]:
        """One for each task and protocol."""
        return [
            Setting(task, protocol, ranges=self.ranges)
            for task in self.tasks
            for protocol in self.protocols
        ]


class Job(NamedTuple):
    """One robot on one episode."""

    robot: Robot
    recipe: Recipe


@dataclass(frozen=True)
class Trial:
    """What came of a job."""

    reason: str = ""  # of the expert: empty if accepted
    detail: str = ""
    success: bool = False  # of a blind robot; of the expert's actions, replayed
    cpu_seconds: float = 0.0  # of the expert's attempt alone
    hash: str = ""
    picture: bytes = b""  # PNG, of a sheet


@dataclass
class Score:
    """Results of one task under one protocol."""

    setting: Setting
    seeds: int
    accepted: int = 0
    rejected: Counter[str] = field(default_factory=Counter[str])
    failures: list[tuple[int, str, str]] = field(default_factory=list)  # seed, reason, detail
    solved: Counter[str] = field(default_factory=Counter[str])  # by robot
    tried: Counter[str] = field(default_factory=Counter[str])
    cpu: list[float] = field(default_factory=list[float])
    hashes: dict[int, set[str]] = field(default_factory=dict)
    good_seed: int | None = None  # the lowest accepted

    @property
    def task(self) -> str:
        return self.setting.task

    @property
    def protocol(self) -> str:
        return self.setting.protocol

    def add(self, robot: Robot, seed: int, trial: Trial) -> None:
        """Counts one trial."""
        self.tried[robot] += 1
        if robot in ("expert", "again") and trial.hash:
            self.hashes.setdefault(seed, set()).add(trial.hash)
        if robot in BLIND:
            self.solved[robot] += trial.success
        if robot == "expert":
            self._add_expert(seed, trial)

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
        return all(len(hashes) == 1 for hashes in self.hashes.values())

    def rate(self, robot: str) -> float | None:
        """Share of successes of a robot, None if it was not tried."""
        tried = self.accepted if robot == "expert" else self.tried[robot]
        return self.solved[robot] / tried if tried else None

    def to_json(self) -> dict[str, object]:
        """Rates are in [0, 1], or null where nothing was tried."""
        ranges = self.setting.ranges
        drawn = ranges is not None and load_protocol(self.protocol).physics
        return {
            "task": self.task,
            "protocol": self.protocol,
            "seeds": self.seeds,
            "accepted": self.accepted,
            "rejected": dict(sorted(self.rejected.items())),
            "replay_success": self.rate("expert"),
            **{f"{robot}_success": self.rate(robot) for robot in BLIND},
            "cpu_seconds_mean": float(np.mean(self.cpu)) if self.cpu else None,
            **({"domain": ranges.name} if ranges and drawn else {}),
        }


@dataclass
class RobotTrials(Study[Job, Trial]):
    """One robot on consecutive seeds of one setting."""

    robot: Robot
    score: Score
    picture: bytes = b""

    def job(self, seed: int) -> Job:
        return Job(self.robot, self.score.setting.at(seed))

    def reason(self, result: Trial) -> str:
        return ""  # every trial is wanted

    def commit(self, seed: int, result: Trial) -> str:
        self.score.add(self.robot, seed, result)
        self.picture = result.picture
        return ""

    def lost(self, seed: int, loss: Lost) -> Trial:
        return Trial(loss.reason, loss.detail)

    def series(self, first: int, count: int) -> Series[Job, Trial]:
        """So many seeds from the first one."""
        name = f"{self.score.task}, {self.score.protocol} ({self.robot})"
        return Series(self, Tally(name, count), range(first, first + count))


def check(plan: CheckPlan, pack: Pack, listener: Listener | None = None) -> list[Score]:
    """Tries the expert, its actions replayed, and the robots that see nothing.

    Raises:
        RtphysError: what `CheckPlan.check` refuses, or an error in a worker.
    """
    plan.check()
    scores = [Score(setting, plan.seeds) for setting in plan.settings()]
    counts: dict[Robot, int] = {"expert": plan.seeds, "again": min(TWICE, plan.seeds)}
    counts |= dict.fromkeys(BLIND, plan.robots)
    series = [
        RobotTrials(robot, score).series(plan.first_seed, count)
        for score in scores
        for robot, count in counts.items()
    ]
    _run(plan, pack, series, listener)
    return scores


def sheet(plan: CheckPlan, pack: Pack, score: Score) -> tuple[int, bytes]:
    """(seed, PNG): one row a camera, one column the end of each stage.

    Shows the lowest accepted seed, or the first failure if there is none. Needs a renderer.
    """
    seed = score.failures[0][0] if score.good_seed is None else score.good_seed
    drawn = RobotTrials("sheet", Score(score.setting, 1))
    _run(replace(plan, workers=1), pack, [drawn.series(seed, 1)])
    return seed, drawn.picture


def _run(
    plan: CheckPlan,
    pack: Pack,
    series: Sequence[Series[Job, Trial]],
    listener: Listener | None = None,
) -> None:
    listener, size = listener or Listener(), cores() if plan.workers is None else plan.workers
    with LocalPool[Job, Trial](CheckWorker(pack), size, plan.limits, listener.noticed) as pool:
        run_all(series, pool, listener)


class CheckWorker(StudyWorker[Job, Trial]):
    """Lets one robot try one episode."""

    def do(self, job: Job) -> Trial:
        robot, recipe = job
        task = self.tasks[recipe.task]
        if robot in BLIND:
            return Trial(success=solves(recipe, task, self.pack, robot))
        if robot == "sheet":
            renderer.configure()  # before the first scene
        began = time.process_time()
        tried = attempt(recipe, task, self.pack)
        spent = time.process_time() - began
        if robot == "sheet":
            return Trial(picture=_picture(task, self.pack, tried))
        recording = tried.recording
        replayed = False
        if robot == "expert" and tried.accepted and recording is not None:
            replayed = replay(recipe, task, self.pack, actions_of(recording))
        state = recording.hash if recording is not None else ""
        return Trial(tried.reason, tried.detail, replayed, spent, state)


def solves(recipe: Recipe, task: Task, pack: Pack, robot: str) -> bool:
    """Whether a robot that sees nothing solves an episode within the task's step limit."""
    try:
        episode = begin(recipe, task, pack)
    except Infeasible:
        return False
    open_policy(robot).play(episode)
    return episode.success


def _picture(task: Task, pack: Pack, tried: Attempt) -> bytes:
    recipe, recording = tried.recipe, tried.recording
    if recording is None:  # not even settled: show what it looks like before anyone acts
        recording = start(prepare(recipe, task, pack)).recorder.recording
    last = {row.stage: row for row in recording.rows}  # of each stage
    ends = replace(recording, rows=list(last.values()))
    images = photograph(recipe, task, pack, ends, SHEET_CAMERAS).images
    columns = [np.concatenate(list(shown.values())) for shown in images]
    return encode_png(np.concatenate(columns, axis=1))
