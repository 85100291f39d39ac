"""Pictures of recorded states: the same world built again with visuals, posed row by row."""

import queue
from collections import defaultdict
from collections.abc import Callable, Hashable, Iterable, Iterator, Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from functools import partial
from itertools import chain
from pathlib import Path
from typing import TypeVar

import numpy as np
from numpy.typing import NDArray

from rtphys.assets.pack import Pack
from rtphys.core.errors import NoRenderer
from rtphys.core.poses import Pose
from rtphys.data.episode import FRAME_RATE, CameraFrames, Images, Sensed
from rtphys.data.files import make_folder, replace_file
from rtphys.data.video import VideoWriter
from rtphys.episode.generate import Instance, prepare
from rtphys.episode.touch import felt
from rtphys.senses import SENSES, drawn
from rtphys.senses.states import BodyPoses
from rtphys.senses.touch import Touch
from rtphys.sim import camera_group, renderer
from rtphys.sim.camera_group import CameraGroup
from rtphys.sim.engine import TIME_STEP, packed_of, unpacked
from rtphys.sim.recorder import FRAME_STEPS, Recording
from rtphys.sim.scene_renderer import SceneRenderer, body_names, matrices
from rtphys.sim.turns import turn
from rtphys.spec import recording
from rtphys.spec.episode import Recipe
from rtphys.spec.recording import USUAL, RecordingSpec
from rtphys.task.spec import Task
from rtphys.visual.look import Backdrop, Look

FRAME_TIME = FRAME_STEPS * TIME_STEP  # [s]
T = TypeVar("T")
Drawn = Callable[[], Images]
"""Gives what is drawn as RGB; in the thread that needs it, since that takes a while."""


class Pictures(Iterable[Images]):
    """Draws the rows of a trajectory as they are consumed, once."""

    def __init__(
        self,
        scene: SceneRenderer,
        trajectory: "StateTrajectory",
        backdrop: Backdrop,
        sensed: Sensed,
    ) -> None:
        self.scene, self._backdrop, self._sensed = scene, backdrop, sensed
        self._rows = zip(trajectory.times, trajectory.packed, strict=True)

    def __iter__(self) -> Iterator[Images]:
        with turn(self.scene.world.scene):
            yield from (images() for _, images in _drawn({0: self}))

    def show(self) -> bool:
        """Lets the scene show the next row; False: there is none."""
        if (row := next(self._rows, None)) is None:
            return False
        time, packed = row
        self.scene.light(self._backdrop.lights_at(round(time / FRAME_TIME)))
        self.scene.show(packed)
        return True

    @property
    def alone(self) -> bool:
        """Whether it is drawn picture by picture, as on a CPU, or if its lights change."""
        return self._backdrop.flickers or bool(camera_group.obstacle())

    @property
    def kind(self) -> Hashable:
        """What those that are drawn in one go have in common."""
        return self.scene.buffers, *((spec.width, spec.height) for spec in self.scene.specs)

    def get(self, reads: Sequence[renderer.Read] | None = None) -> dict[str, renderer.Picture]:
        """The pictures of the row that is shown; `reads` as for `SceneRenderer.frames`."""
        seen = self.scene.frames(reads)
        for name, frame in seen.items():
            self._sensed.keep(name, frame.senses)
        return {name: frame.rgb for name, frame in seen.items()}


@dataclass(frozen=True, eq=False)
class RenderedFrames:
    """Pictures of T rows, and where their cameras were.

    `images` is drawn as it is consumed, once; each item holds fresh (H, W, 3) RGB arrays.
    """

    cameras: Mapping[str, CameraFrames]  # by official name
    first_poses: Mapping[str, Pose]  # world pose at the first row: x forward, y left, z up
    images: Pictures
    look: Look
    sensed: Sensed | None = None  # complete once `images` is consumed; None: nothing asked for

    def poses_json(self) -> dict[str, dict[str, list[float]]]:
        """`first_poses` as a label has them."""
        return {
            name: {"position": X.p.tolist(), "quaternion_wxyz": X.q.tolist()}
            for name, X in self.first_poses.items()
        }


@dataclass(frozen=True)
class StateTrajectory:
    """What is drawn: instants, and the packed poses of all bodies at each."""

    times: Sequence[float]  # [s] since the policy stage began
    packed: Sequence[bytes]  # `scene.pack_poses()` of each
    touch: Touch | None = None  # what the fingers felt, if it was recorded

    @staticmethod
    def of(recording: Recording) -> "StateTrajectory":
        rows, track = recording.rows, recording.touch
        touch = None if track is None else felt(track)
        return StateTrajectory([row.time for row in rows], [row.packed for row in rows], touch)

    @staticmethod
    def of_poses(times: Sequence[float], bodies: BodyPoses) -> "StateTrajectory":
        return StateTrajectory(times, [packed_of(poses) for poses in bodies.poses])


def render_frames(
    recipe: Recipe, task: Task, pack: Pack, trajectory: StateTrajectory, recording: RecordingSpec
) -> RenderedFrames:
    """Draws instants of this very recipe. `renderer.configure` has chosen the shader before.

    Raises `NoRenderer`: `renderer.configure` has not run in this process; `BadValue`: senses are
    asked for, and the shader gives none.
    """
    if not renderer.pictures_ready():
        raise NoRenderer("renderer.configure must run before the first world with visuals")
    senses = recording.senses
    renderer.hold_anchor(drawn(senses))
    instance = prepare(recipe, task, pack, visuals=True, look=recording.look)
    scene = SceneRenderer(instance.world, recording)
    poses: dict[str, list[Pose]] = {view.name: [] for view in scene.specs}
    for packed in trajectory.packed:
        scene.show(packed)
        for name, pose in scene.poses().items():
            poses[name].append(pose)
    cameras: dict[str, CameraFrames] = {}
    for view in scene.specs:
        stacks = zip(*(matrices(view, pose) for pose in poses[view.name]), strict=True)
        cameras[view.name] = CameraFrames(*(np.stack(stack) for stack in stacks))
    sensed = Sensed(senses, names={**scene.names})
    for sense in (SENSES[name] for name in senses if not SENSES[name].drawn):
        source: BodyPoses | Touch | None = trajectory.touch
        if sense.scope == "bodies":
            states = np.stack([unpacked(packed) for packed in trajectory.packed])
            source = BodyPoses(body_names(scene.world, states.shape[1]), states)
        if source is not None:
            sensed.names |= source.kinds
            sensed.tracks |= {(key, ""): frames for key, frames in sense.capture(source).items()}
    first = {name: track[0] for name, track in poses.items()}
    images = Pictures(scene, trajectory, instance.look.backdrop, sensed)
    return RenderedFrames(cameras, first, images, instance.look, sensed if senses else None)


def draw_together(
    group: Sequence[Pictures], use: Sequence[Callable[[Iterator[Images]], T]]
) -> list[T]:
    """Draws several trajectories row by row, on a CUDA GPU all pictures of a row in one go; each
    is the one that is drawn alone.

    `use`: what becomes of each one's pictures, in a thread of its own.
    """
    lines = [queue.Queue[Drawn | None](1) for _ in group]  # None ends it

    def consume(number: int) -> T:
        drawn = iter(lines[number].get, None)
        try:
            return use[number](images() for images in drawn)
        finally:  # nobody may wait for a place in the line
            for _ in drawn:
                pass

    with ThreadPoolExecutor(len(group), "rtphys-group") as pool:
        results = [pool.submit(consume, number) for number in range(len(group))]
        try:
            with turn(group[0].scene.world.scene):
                for part in _parts(group):
                    for number, images in _drawn(part):
                        lines[number].put(images)
        finally:
            for line in lines:
                line.put(None)
        return [result.result() for result in results]


def _parts(group: Sequence[Pictures]) -> Iterable[dict[int, Pictures]]:
    """What is drawn in one go, by place in the group."""
    parts = defaultdict[Hashable, dict[int, Pictures]](dict)
    for number, one in enumerate(group):
        parts[number if one.alone else one.kind][number] = one
    return parts.values()


def _drawn(part: Mapping[int, Pictures]) -> Iterator[tuple[int, Drawn]]:
    """The pictures of each, row by row, with its number."""
    left = {number: one for number, one in part.items() if one.show()}
    if any(one.alone for one in part.values()):
        while left:
            yield from ((number, one.get().copy) for number, one in left.items())
            left = {number: one for number, one in left.items() if one.show()}
        return
    scenes = {number: one.scene for number, one in left.items()}
    views = {number: (one.world.scene, one.components) for number, one in scenes.items()}
    with CameraGroup(views, next(iter(scenes.values())).buffers) as group:
        while left:
            reads = group.draw(left)
            yield from ((number, partial(one.get, reads[number])) for number, one in left.items())
            left = {number: one for number, one in left.items() if one.show()}


# ---- the video of an evaluated episode -----------------------------------------------------------


CAMERAS = tuple(recording.CAMERAS[name] for name in USUAL)
KEYFRAMES = 50  # at least every three seconds, so that a player can jump


def write_video(instance: Instance, recording: Recording, pack: Pack, path: Path) -> None:
    """Draw the rows of a recording as an MP4, 320 x 360 at 16.67 Hz.

    Raises `NoRenderer`: no device to draw with; `CannotWrite`: the file system refuses.
    """
    renderer.hold_anchor()
    recipe, task, states = instance.recipe, instance.task, StateTrajectory.of(recording)
    rendered = render_frames(recipe, task, pack, states, RecordingSpec(CAMERAS))
    pictures = map(montage, rendered.images)
    first = next(pictures)
    height, width, _ = first.shape
    writer = VideoWriter(height, width, FRAME_RATE, KEYFRAMES)
    for picture in chain([first], pictures):
        writer.add(picture)
    make_folder(path.parent)
    replace_file(path, writer.finish())


def montage(images: Images) -> NDArray[np.uint8]:
    """Head (H, W, 3) over left and right wrist at half size: (3 H / 2, W, 3)."""
    head, *wrists = (images[name] for name in CAMERAS)
    h, w, c = head.shape
    cells = np.stack(wrists).reshape(2, h // 2, 2, w // 2, 2, c)
    left, right = cells.mean(axis=(2, 4)).astype(np.uint8)  # every pixel the mean of four
    return np.concatenate([head, np.concatenate([left, right], axis=1)])
