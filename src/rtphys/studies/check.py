"""What an author wants to know of a task: does the expert solve it, and does nobody else?"""

import time
import traceback
from collections import Counter
from collections.abc import Callable, Collection, Mapping, Sequence
from dataclasses import dataclass, field, replace
from itertools import product
from math import acos
from typing import Literal, NamedTuple

import numpy as np
from numpy.typing import NDArray

from rtphys.assets.pack import Pack
from rtphys.campaign.local import run_here
from rtphys.campaign.pool import LOSSES
from rtphys.campaign.series import QUIET, Batch, Listener
from rtphys.core.errors import Infeasible, counted
from rtphys.core.poses import Pose
from rtphys.episode import begin
from rtphys.episode.generate import Attempt, attempt, prepare, start
from rtphys.episode.render import StateTrajectory, render_frames
from rtphys.expert.grasp import HeldLoad, turn_of
from rtphys.plan.kinematics import check_robot
from rtphys.policies import open_policy
from rtphys.sim.recorder import Recording
from rtphys.spec.episode import EpisodeSpec, Recipe
from rtphys.spec.protocol import load_protocol
from rtphys.spec.recording import RecordingSpec
from rtphys.studies.requests import CheckPlan
from rtphys.studies.worker import StudyWorker
from rtphys.task.arm import Arm, Motion, Placing, Robot, Scene
from rtphys.task.instructions import check_sentences
from rtphys.task.spec import Task, load_task

MAX_BASELINE = 20  # seeds of each baseline, unless more are asked for
TWICE = 2  # seeds that the expert does twice, to compare the states

Role = Literal["expert", "again", "idle", "random", "jitter"]
BASELINES: tuple[Role, ...] = ("idle", "random", "jitter")  # they see nothing, and must fail


class CheckTask(NamedTuple):
    """One policy on one episode."""

    role: Role
    recipe: Recipe


@dataclass(frozen=True)
class CheckResult:
    """What came of one policy on one episode."""

    reason: str = ""  # of the expert: empty if accepted
    detail: str = ""
    success: bool = False  # of a baseline; of the expert's actions, replayed
    cpu_seconds: float | None = None  # of the expert's attempt alone; a lost worker tells none
    hash: str = ""  # of the expert's states


@dataclass
class Score:
    """Results of one task under one protocol."""

    spec: EpisodeSpec
    results: dict[Role, Mapping[int, CheckResult]] = field(default_factory=dict)  # each by seed

    def tried(self, role: Role) -> Collection[CheckResult]:
        """The results of the expert or of a baseline."""
        return self.results.get(role, {}).values()

    def solved(self, role: Role) -> int:
        """Number of their successes."""
        return sum(one.success for one in self.tried(role))

    def played(self, role: Role) -> int:
        """Number of a baseline's episodes; of the expert's accepted actions, replayed."""
        return len(self.accepted) if role == "expert" else len(self.tried(role))

    def rate(self, role: Role) -> float | None:
        """Share of `solved` in `played`; None: nothing was played."""
        played = self.played(role)
        return self.solved(role) / played if played else None

    @property
    def accepted(self) -> list[int]:
        """Seeds that the expert solves."""
        return [seed for seed, one in self.results["expert"].items() if not one.reason]

    @property
    def failures(self) -> dict[int, CheckResult]:
        """The expert's failures by seed."""
        return {seed: one for seed, one in self.results["expert"].items() if one.reason}

    @property
    def rejected(self) -> Counter[str]:
        """Number of the expert's failures by reason."""
        return Counter(one.reason for one in self.failures.values())

    @property
    def cpu_seconds(self) -> float | None:
        """Mean of the expert's attempts, without those whose worker was lost; None: all were."""
        known = [s for one in self.tried("expert") if (s := one.cpu_seconds) is not None]
        return float(np.mean(known)) if known else None

    @property
    def deterministic(self) -> bool:
        """Whether each seed that was tried twice ended alike after the same states."""
        first, again = self.results["expert"], self.results["again"]
        pairs = [(first[seed], one) for seed, one in again.items()]
        known = [pair for pair in pairs if not any(one.reason in LOSSES for one in pair)]
        return all((a.reason, a.hash) == (b.reason, b.hash) for a, b in known)

    def to_json(self) -> dict[str, object]:
        """Rates are in [0, 1], or null where nothing was tried. So is the CPU time where no
        attempt came to its end."""
        spec, ranges = self.spec, self.spec.ranges
        drawn = ranges is not None and load_protocol(spec.protocol).physics
        return {
            "task": spec.task,
            "protocol": spec.protocol,
            "seeds": len(self.tried("expert")),
            "accepted": len(self.accepted),
            "rejected": dict(sorted(self.rejected.items())),
            "failures": [
                {"seed": seed, "reason": one.reason, "detail": one.detail}
                for seed, one in sorted(self.failures.items())
            ],
            "replay_success": self.rate("expert"),
            **{f"{role}_success": self.rate(role) for role in BASELINES},
            "cpu_seconds_mean": self.cpu_seconds,
            **({"domain": ranges.name} if ranges and drawn else {}),
        }


def check(plan: CheckPlan, pack: Pack, listener: Listener = QUIET) -> list[Score]:
    """Tries the expert, its actions replayed, and, where it solves a seed, the baselines.

    Raises `RtphysError`.
    """
    check_robot(pack, plan.episode.embodiment)
    for name in plan.tasks:
        check_sentences(load_task(name))
    blind = min(plan.seeds, MAX_BASELINE) if plan.baselines is None else plan.baselines
    cells = product(plan.tasks, plan.protocols)
    scores = [Score(replace(plan.episode, task=task, protocol=name)) for task, name in cells]
    experts: dict[Role, int] = {"expert": plan.seeds, "again": min(TWICE, plan.seeds)}
    _run(scores, experts, plan, pack, listener)
    solved = [score for score in scores if score.accepted]
    if len(solved) < len(scores):
        left = f"{counted(len(scores) - len(solved), 'pairs')} of task and protocol"
        listener.noticed(f"the baselines skip {left}, where the expert solves none")
    if solved and blind:
        _run(solved, dict.fromkeys(BASELINES, blind), plan, pack, listener)
    return scores


def _run(
    scores: Sequence[Score],
    counts: Mapping[Role, int],
    plan: CheckPlan,
    pack: Pack,
    listener: Listener,
) -> None:
    """Fills in the results of these roles, so many seeds each."""
    batches = list[Batch[CheckTask, CheckResult]]()
    for score, (role, count) in product(scores, counts.items()):
        called = "expert, determinism check" if role == "again" else role
        seeds = range(plan.first_seed, plan.first_seed + count)
        batch = Batch(
            f"{score.spec.task}, {score.spec.protocol} ({called})",
            {seed: CheckTask(role, score.spec.at(seed)) for seed in seeds},
            lambda job, loss: CheckResult(loss.reason, loss.detail),
            lambda one, blind=role in BASELINES: one.success if blind else not one.reason,
            by="baselines" if role in BASELINES else "expert",
        )
        score.results[role] = batch.results
        batches.append(batch)
    run_here(batches, CheckWorker(pack), plan.workers, listener)


class CheckWorker(StudyWorker[CheckTask, CheckResult]):
    """Lets the expert or a baseline try one episode."""

    def do(self, job: CheckTask) -> CheckResult:
        role, recipe = job
        if role in BASELINES:
            return CheckResult(success=solves(recipe, self.tasks[recipe.task], self.pack, role))
        began = time.process_time()
        tried = self.demonstrate(recipe)
        spent = time.process_time() - began
        replayed = role == "expert" and bool(self.replay(recipe, tried))
        state = tried.recording.hash if tried.recording is not None else ""
        return CheckResult(tried.reason, tried.detail, replayed, spent, state)


def solves(recipe: Recipe, task: Task, pack: Pack, role: str) -> bool:
    """Whether a baseline solves an episode within the task's step limit."""
    try:
        episode = begin(recipe, task, pack, keep="nothing")
    except Infeasible:
        return False
    open_policy(role).play(episode)
    return episode.success


SHEET_CAMERAS = ("head", "left", "right", "front")


@dataclass(frozen=True)
class Placed:
    """What a script asked a hand to place, and where."""

    side: str
    prop: str
    target: Pose  # in the task's frame
    tilt: float  # [rad] of the prop away from how it is held, as the target asks for it


@dataclass(frozen=True, eq=False)
class Watched:
    """An attempt, the line of the script at which it ended, and the last placement asked for."""

    attempt: Attempt
    line: str = ""  # `file.py:12: its text`; empty where the script came to its end
    placed: Placed | None = None

    @property
    def stages(self) -> list[tuple[str, float, float]]:
        """Name of each stage, first and last instant [s]."""
        recording, found = self.attempt.recording, dict[int, tuple[float, float]]()
        for row in recording.rows if recording else ():
            found[row.stage] = (found.get(row.stage, (row.time,))[0], row.time)
        names = recording.stages if recording else ()
        return [(names[stage], *times) for stage, times in found.items()]


def watch(recipe: Recipe, task: Task, pack: Pack) -> Watched:
    """Lets the expert try one episode. Never renders."""
    placed, lines = list[Placed](), list[str]()

    def script(robot: Robot) -> None:
        for arm in (robot.left, robot.right):
            setattr(arm, "place", _noting(arm, robot.scene, placed))  # noqa: B010 - of this one arm
        try:
            task.script(robot)
        except Infeasible as problem:
            frames = traceback.extract_tb(problem.__traceback__)
            own = [frame for frame in frames if frame.filename == str(task.source)]
            lines.extend(f"{task.source.name}:{frame.lineno}: {frame.line}" for frame in own[-1:])
            raise

    tried = attempt(recipe, replace(task, script=script), pack)
    return Watched(tried, lines[-1] if lines else "", placed[-1] if placed else None)


def _noting(arm: Arm, scene: Scene, found: list[Placed]) -> Callable[..., Motion]:
    """The arm's `place`, which notes what it is asked for."""
    place = arm.place

    def noted(
        prop: str, target: Pose, point: int | None = None, how: Placing | None = None
    ) -> Motion:
        functional = None if point is None else scene.functional(prop, point)
        load = HeldLoad(arm.side, arm.ee(), scene.pose(prop), functional)
        turn = Pose((0, 0, 0), turn_of(load, target, how or Placing())).R
        tilt = acos(float(np.clip(turn[2, 2], -1, 1)))
        found.append(Placed(arm.side, prop, target, tilt))
        return place(prop, target, point, how)

    return noted


def stage_ends(
    tried: Attempt, task: Task, pack: Pack
) -> tuple[Sequence[str], Mapping[str, Sequence[NDArray[np.uint8]]]]:
    """Stages of an attempt, and by camera what is seen at the end of each; needs a renderer."""
    recording: Recording | None = tried.recording
    if recording is None:  # not even settled: show what it looks like before anyone acts
        recording = start(prepare(tried.recipe, task, pack)).recorder.recording
    last = {row.stage: row for row in recording.rows}  # of each stage
    states = StateTrajectory.of(replace(recording, rows=list(last.values())))
    frames = render_frames(tried.recipe, task, pack, states, RecordingSpec(SHEET_CAMERAS))
    images = list(frames.images)
    stages = [recording.stages[stage] for stage in last]
    return stages, {camera: [shown[camera] for shown in images] for camera in images[0]}
