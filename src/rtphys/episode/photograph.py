"""Pictures of a recording: the same world built again with visuals, posed row by row."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from rtphys.assets.pack import Pack
from rtphys.core.errors import NoRenderer
from rtphys.core.poses import Pose
from rtphys.data.episode import CameraFrames, Images
from rtphys.episode.instance import prepare
from rtphys.setting.setting import Recipe
from rtphys.sim import renderer
from rtphys.sim.engine import TIME_STEP
from rtphys.sim.recorder import FRAME_STEPS, Recording, Row
from rtphys.sim.studio import Studio, matrices
from rtphys.task.spec import Task
from rtphys.visual import Backdrop

FRAME_TIME = FRAME_STEPS * TIME_STEP  # [s]


@dataclass(frozen=True, eq=False)
class Photographs:
    """Pictures of T rows, and where their cameras were.

    `images` is drawn as it is consumed, once; each item holds fresh (H, W, 3) RGB arrays.
    """

    cameras: Mapping[str, CameraFrames]  # by official name
    first_poses: Mapping[str, Pose]  # world pose at the first row: x forward, y left, z up
    images: Iterator[Images]


def photograph(
    recipe: Recipe, task: Task, pack: Pack, recording: Recording, cameras: Sequence[str]
) -> Photographs:
    """Draws a recording of this very recipe. `renderer.configure` has chosen the shader before.

    Args:
        cameras: short or official names.

    Raises:
        NoRenderer: `renderer.configure` has not run in this process.
        UnknownName: no such camera.
    """
    if not renderer.pictures_ready():
        raise NoRenderer("renderer.configure must run before the first world with visuals")
    renderer.hold_anchor()
    instance = prepare(recipe, task, pack, visuals=True)
    studio = Studio(instance.world, cameras)
    poses: dict[str, list[Pose]] = {spec.name: [] for spec in studio.specs}
    for row in recording.rows:
        studio.show(row.packed)
        for name, pose in studio.poses().items():
            poses[name].append(pose)
    frames = {spec.name: _frames(studio, spec.name, poses[spec.name]) for spec in studio.specs}
    first = {name: track[0] for name, track in poses.items()}
    return Photographs(frames, first, _draw(studio, recording.rows, instance.look.backdrop))


def _draw(studio: Studio, rows: Sequence[Row], backdrop: Backdrop) -> Iterator[Images]:
    for row in rows:
        studio.light(backdrop.lights_at(round(row.time / FRAME_TIME)))
        studio.show(row.packed)
        yield studio.pictures()


def _frames(studio: Studio, name: str, poses: Sequence[Pose]) -> CameraFrames:
    spec = next(spec for spec in studio.specs if spec.name == name)
    stacks = zip(*(matrices(spec, pose) for pose in poses), strict=True)
    return CameraFrames(*(np.stack(stack) for stack in stacks))
