"""Features: what each arm was commanded and sensed in an episode, as statistics of each stage.

No state of any object is among them, nor the margin to the friction cone: whoever knows that margin
knows the friction.
"""

from collections import Counter
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from rtphys.analysis.identify import IdentifyPlan
from rtphys.analysis.scoring import Sample
from rtphys.assets.action_layout import SIDES
from rtphys.assets.embodiment import Embodiment
from rtphys.assets.pack import Pack
from rtphys.campaign.local import run_here
from rtphys.campaign.pool import WorkerFailure
from rtphys.campaign.series import QUIET, Listener, Progress, Series
from rtphys.core.code_digest import code_digest
from rtphys.core.poses import Array
from rtphys.data import files
from rtphys.data.json_text import plain
from rtphys.data.ledger import Ledger
from rtphys.data.lock import FolderLock
from rtphys.episode.fingerprint import fingerprint_of
from rtphys.episode.touch import felt
from rtphys.physics import could_act
from rtphys.plan.kinematics import ArmKinematics, arm_kinematics
from rtphys.senses.touch import Touch
from rtphys.sim.recorder import RECOVER, Recording
from rtphys.spec.episode import EpisodeSpec, Recipe
from rtphys.spec.option import checked_dataclass
from rtphys.studies.worker import StudyWorker
from rtphys.task.props import parts
from rtphys.task.spec import load_task

NUDGE = 1e-5  # [rad] by which a joint is turned to measure how the tool moves
WEAKEST = 0.02  # share of the strongest direction below which effort is no evidence of force
MIN_LOAD = 0.5  # [N] of force below which the ratio of another one to it is noise
MIN_SLIP = 0.002  # [m/s] from which a pad counts as slipping
PADS = {
    "normal": np.mean,  # [N]
    "normal_peak": np.max,
    "tangential": np.mean,  # [N]
    "tangential_peak": np.max,
    "slip": np.max,  # of the object along the pads [m/s]
}
"""Array of `Touch` -> how the fingers of one gripper are combined."""

WRENCH = ("force_x", "force_y", "force_z", "moment_x", "moment_y", "moment_z")
WHOLE = "whole"  # the stage that stands for the whole episode
MAX_IDLE = 0.02  # share of the busier arm's way [rad] up to which an arm counts as idle
BOTH = 0.5  # share of it from which both arms are busy, and left comes first
DIGITS = 6  # significant digits that are kept
ROLES = ("hand", "other")  # the busier arm, and the other one where it is not idle


@dataclass(frozen=True, eq=False)
class ArmRows:
    """What one arm with its gripper was commanded and sensed in T rows."""

    commands: Array  # (T, n) joint targets [rad]
    opening_commands: Array  # (T,) 0 closed .. 1 open
    joints: Array  # (T, n) measured [rad]
    opening: Array  # (T,) measured, in the unit of its commands
    effort: Array  # (T, n) measured [N m]
    finger_effort: Array  # (T, f) measured [N]
    touch: Array  # (T,) 1 where the gripper presses on any object, else 0
    pads: Mapping[str, Array]  # (T,) each of `PADS`; zeros for a recording without touch
    kinematics: ArmKinematics
    tcp: float  # [m] from the ee frame to the tool centre point, along x


def arm_rows(
    recording: Recording, embodiment: Embodiment, touch: Touch | None = None
) -> list[ArmRows]:
    """The rows of a recording by arm, left then right; `touch`: what the fingers felt in them."""
    rows, layout = recording.rows, recording.layout
    commands = np.array([row.arms for row in rows])
    qpos = np.array([row.qpos for row in rows])
    effort = np.array([row.effort for row in rows])
    touched = np.array([[*map(any, zip(*row.touched.values(), strict=True))] for row in rows])
    arms: list[ArmRows] = []
    for i, limb in enumerate(sorted(embodiment.limbs, key=lambda limb: limb.side)):
        joints = [recording.joint_names.index(name) for name in limb.joints]
        fingers = [recording.joint_names.index(name) for name in limb.finger_joints]
        pads = {name: np.zeros(len(rows)) for name in PADS}
        if touch is not None:
            each = len(touch.fingers) // 2
            own = slice(i * each, (i + 1) * each)  # the left hand's come first
            felt_by = {name: getattr(touch, name)[:, own].astype(float) for name in PADS}
            pads = {name: combine(felt_by[name], axis=1) for name, combine in PADS.items()}
        arms.append(
            ArmRows(
                commands=commands[:, layout.arms[i]],
                opening_commands=commands[:, layout.grippers[i]],
                joints=qpos[:, joints],
                opening=qpos[:, fingers].sum(axis=1) / (2 * limb.hand.finger_open),
                effort=effort[:, joints],
                finger_effort=effort[:, fingers],
                touch=touched[:, i].astype(float),
                pads=pads,
                kinematics=arm_kinematics(embodiment)[limb.side],
                tcp=limb.hand.tcp,
            )
        )
    return arms


def signals(arm: ArmRows) -> dict[str, Array]:
    """`group/name` -> values (T,) of one arm.

    Of joints, by the arm's own kinematics, also the tool's place [m] and where it points; of effort
    also the force [N] and moment [N m] on the tool that explain it. The ratio of the pads' forces
    is the friction of what slips; elsewhere it says only that it holds.
    """
    poses = np.array([arm.kinematics.ee_matrix(q) for q in arm.joints])
    points = poses[:, :3, 0]
    tools = {"tool": poses[:, :3, 3] + arm.tcp * points, "points": points}
    wrench = np.array([tool_wrench(arm, q, e) for q, e in zip(arm.joints, arm.effort, strict=True)])
    across, along = np.hypot(wrench[:, 0], wrench[:, 1]), np.abs(wrench[:, 2])
    ratio = arm.pads["tangential"] / np.maximum(arm.pads["normal"], MIN_LOAD)
    groups = {
        "commands": {
            **_numbered("command", arm.commands),
            "command_opening": arm.opening_commands,
        },
        "joints": {
            **_numbered("joint", arm.joints),
            "opening": arm.opening,
            **{f"{n}_{x}": at[:, k] for n, at in tools.items() for k, x in enumerate("xyz")},
        },
        "tracking": {
            **_numbered("lag", arm.commands - arm.joints),
            "lag_opening": arm.opening_commands - arm.opening,
        },
        "effort": {
            **_numbered("effort", arm.effort),
            "squeeze": np.abs(arm.finger_effort).mean(axis=1),
            **dict(zip(WRENCH, wrench.T, strict=True)),
            "force_ratio": across / np.maximum(along, MIN_LOAD),
        },
        "touch": {
            "touch": arm.touch,
            **arm.pads,
            "ratio": ratio,
            "slipping_ratio": np.where(arm.pads["slip"] > MIN_SLIP, ratio, 0.0),
        },
    }
    return {f"{group}/{name}": x for group, named in groups.items() for name, x in named.items()}


def _numbered(name: str, values: Array) -> dict[str, Array]:
    return {f"{name}_{k}": column for k, column in enumerate(values.T, start=1)}


def tool_wrench(arm: ArmRows, q: Array, effort: Array) -> Array:
    """Force [N] and moment [N m] on the tool centre point, (6,) world frame, at rest.

    By virtual work, effort = -JᵀF. Directions in which the arm is nearly straight say little and
    count as zero.
    """
    jacobian = np.empty((len(q), 6))  # velocity and angular velocity per unit speed of a joint
    for row, nudge in zip(jacobian, NUDGE * np.eye(len(q)), strict=True):
        ahead, behind = (arm.kinematics.ee_matrix(q + sign * nudge) for sign in (1, -1))
        change = (ahead - behind) / (2 * NUDGE)
        spin = change[:3, :3] @ behind[:3, :3].T
        turn = (spin[2, 1] - spin[1, 2], spin[0, 2] - spin[2, 0], spin[1, 0] - spin[0, 1])
        row[:3], row[3:] = (change @ (arm.tcp, 0, 0, 1))[:3], 0.5 * np.array(turn)
    return -np.linalg.pinv(jacobian, rcond=WEAKEST) @ effort


def features_of(
    recording: Recording, embodiment: Embodiment, touch: Touch | None = None
) -> dict[str, float | list[float]]:
    """The features of one episode, see `Sample.features`. An arm that is idle has none.

    The busier arm is the hand, the other one is the other; of two that are busy left comes first.
    """
    arms = arm_rows(recording, embodiment, touch)
    time = np.array([row.time for row in recording.rows])
    ways = np.array([np.abs(np.diff(arm.commands, axis=0)).sum() for arm in arms])
    busy = int(np.argmax(ways))
    order, share = [busy], ways[1 - busy] / max(float(ways[busy]), 1e-9)
    if share > MAX_IDLE:
        order = [0, 1] if share >= BOTH else [busy, 1 - busy]
    sensed = {role: signals(arms[i]) for role, i in zip(ROLES, order, strict=False)}
    values: dict[str, float | list[float]] = {f"{WHOLE}/side": float(order[0])}
    for stage, rows in _stages(recording):
        values[f"{stage}/duration"] = _kept(float(time[rows[-1]] - time[rows[0]]))
        for role, named in sensed.items():
            for name, signal in named.items():
                x = signal[rows]
                statistics = (x.mean(), x.std(), x.min(), x.max(), x[-1], x[-1] - x[0])
                values[f"{stage}/{role}/{name}"] = [*map(_kept, statistics)]  # as `STATISTICS`
    return values


def _kept(value: float) -> float:
    return float(f"{value:.{DIGITS}g}")


def _stages(recording: Recording) -> Iterator[tuple[str, NDArray[np.intp]]]:
    """Name and indices of the rows of each stage, then those of the whole episode.

    A stage that comes again has a number behind its name.
    """
    of = np.array([row.stage for row in recording.rows])
    seen: Counter[str] = Counter()
    for index, stage in enumerate(recording.stages):
        rows = np.flatnonzero(of == index)
        name = without_sides(stage)
        seen[name] += 1
        if len(rows):
            yield name if seen[name] == 1 else f"{name} {seen[name]}", rows
    yield WHOLE, np.arange(len(of))


def without_sides(stage: str) -> str:
    """The name of a stage whatever the arm: `left grasp pot + right grasp pot` is `grasp pot`."""
    again = f"{RECOVER} " if stage.startswith(f"{RECOVER} ") else ""
    parts = [part.strip() for part in stage.removeprefix(again).split(" + ")]
    words = [part.partition(" ") for part in parts]
    names = [
        rest if first in SIDES and rest else part
        for part, (first, _, rest) in zip(parts, words, strict=True)
    ]
    return (again + " + ".join(dict.fromkeys(names))).replace("/", "-")


@checked_dataclass(frozen=True)
class FeaturesSpec:
    """What decides the features of one task's episodes: the first line of their ledger."""

    episode: EpisodeSpec
    first_seed: int
    fingerprint: Mapping[str, Any]  # of task, domain, assets and code
    features: str  # digest of the code that makes them


class SenseWorker(StudyWorker[Recipe, Sample]):
    """Lets the expert try a seed, without pictures, and keeps features of what a robot senses."""

    def do(self, job: Recipe) -> Sample:
        tried = self.demonstrate(job, touch=True)
        recording, instance = tried.recording, tried.instance
        if not tried.accepted or recording is None or instance is None or recording.touch is None:
            return Sample(job.seed, reason=tried.reason)
        physics = instance.physics
        labelled = could_act(physics, parts(instance.props)) & physics.varied
        robot = instance.world.robot.embodiment
        return Sample(
            job.seed,
            features=features_of(recording, robot, felt(recording.touch)),
            labels={key: plain(physics[key], key) for key in sorted(labelled)},  # type: ignore[misc] - numbers
        )


class TaskEpisodes(Series[Recipe, Sample]):
    """The seeds of one task, in order, in a ledger that later runs continue.

    Raises `DatasetMismatch`: the ledger was made under other conditions; `BadFile`: it is damaged.
    """

    def __init__(self, plan: IdentifyPlan, spec: FeaturesSpec) -> None:
        accepted: list[bool] = []
        self.spec, self.path = spec.episode, plan.features_file(spec.episode.task)
        self._ledger = Ledger(self.path, spec, Sample, lambda row: accepted.append(not row.reason))
        done = min(sum(accepted), plan.episodes)
        progress = Progress(self.spec.task, plan.episodes, done, len(accepted))
        progress.fruitless = [True, *accepted][::-1].index(True)  # given up where it was before
        seeds = range(plan.first_seed, plan.first_seed + plan.max_attempts)[len(accepted) :]
        super().__init__(progress, seeds)

    def job(self, seed: int) -> Recipe:
        return self.spec.at(seed)

    def reason(self, result: Sample) -> str:
        return result.reason

    def commit(self, seed: int, result: Sample) -> str:
        self._ledger.append(result)
        return ""

    def lost(self, seed: int, loss: WorkerFailure) -> Sample:
        return Sample(seed, reason=loss.reason)


def sense(plan: IdentifyPlan, pack: Pack, listener: Listener = QUIET) -> None:
    """Simulates the episodes that are missing, and keeps what a robot senses in them as features.

    The files depend on the plan alone, not on the number of workers, nor on how often the run was
    killed and resumed. Raises `RtphysError`: features made under other conditions; another run at
    work in the folder; an error in a worker.
    """
    code = code_digest([Path(__file__)])
    files.make_folder(plan.out)
    with FolderLock(plan.out):
        studies = list[TaskEpisodes]()
        for spec in plan.specs():
            ground = fingerprint_of(load_task(spec.task), spec.protocol, pack).to_json()
            studies.append(TaskEpisodes(plan, FeaturesSpec(spec, plan.first_seed, ground, code)))
        run_here(studies, SenseWorker(pack), plan.workers, listener, plan.out)
