"""One attempt of the expert, watched: its stages, and where its script stuck."""

import traceback
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from math import acos

import numpy as np
from numpy.typing import NDArray

from rtphys.assets.pack import Pack
from rtphys.core.errors import Infeasible
from rtphys.core.poses import Pose
from rtphys.episode.generate import Attempt, attempt, prepare, start
from rtphys.episode.render import StateTrajectory, render_frames
from rtphys.expert.grasp import HeldLoad, turn_of
from rtphys.sim.recorder import Recording
from rtphys.spec.episode import Recipe
from rtphys.spec.recording import RecordingSpec
from rtphys.task.arm import Arm, Motion, Placing, Robot, Scene
from rtphys.task.spec import Task

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
            own = [f for f in traceback.extract_tb(problem.__traceback__) if _is_script(f, task)]
            lines.extend(f"{task.source.name}:{frame.lineno}: {frame.line}" for frame in own[-1:])
            raise

    tried = attempt(recipe, replace(task, script=script), pack)
    return Watched(tried, lines[-1] if lines else "", placed[-1] if placed else None)


def _is_script(frame: traceback.FrameSummary, task: Task) -> bool:
    return frame.filename == str(task.source)


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
