"""Cameras of several scenes that a CUDA GPU draws in one go, and whose pictures one copy reads.

A picture alone is waited for: on an H200 that takes 2.5 ms, of which the GPU works 0.3. SAPIEN's
camera groups avoid that, but leave poses to the caller. They are put in place here as SAPIEN itself
computes them for `take_picture`, so that each picture equals that one to the pixel. (Its own
kernels, `RenderSystemGroup.update_render`, round otherwise: 0.2 % of the pixels differ.)
"""

from collections.abc import Iterable, Mapping, Sequence
from functools import cache
from pathlib import Path
from typing import Any, Self

import numpy as np
import sapien
from numpy.typing import NDArray

from rtphys.sim import cuda, renderer

Camera = sapien.render.RenderCameraComponent

# Turns the axes of a camera (x forward, y left, z up) into OpenGL's, as SAPIEN does.
GL_FROM_SAPIEN = sapien.Pose(q=[-0.5, -0.5, 0.5, 0.5])
MATRICES = 48  # numbers that a camera's buffer begins with: view, projection, inverse of the view
UPLOADER = str(Path(sapien.__file__).parent / "vulkan_shader" / "minimal")  # the cheapest shader


class CameraGroup:
    """Draws the cameras of several scenes together.

    Args:
        views: by number a scene and its cameras; of each scene as many, in the same order and of
            the same sizes. The lights are those of now: they do not change any more.
        names: of the pictures to read.

    From then on the cameras draw in this group alone. Raises `RuntimeError`.
    """

    def __init__(
        self, views: Mapping[int, tuple[sapien.Scene, Sequence[Camera]]], names: Sequence[str]
    ) -> None:
        self._views, self._names = views, list(names)
        self._uploaders = {n: _uploader(cameras[0]) for n, (_, cameras) in views.items()}
        self._drawn: list[int] = []
        self._pictures: list[dict[str, cuda.PinnedArray]] = []  # of each camera, by name

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *error: object) -> None:
        for pictures in (one for of_camera in self._pictures for one in of_camera.values()):
            pictures.close()
        self._pictures = []

    def draw(self, numbers: Iterable[int]) -> dict[int, list[renderer.Read]]:
        """Draws what these scenes show after `update_render`; pictures of each scene's cameras.

        Each time no more than the time before: what has ended is soon left out.
        """
        wanted = list(numbers)
        if 2 * len(wanted) <= len(self._drawn) or not self._drawn:
            self._form(wanted)
        self._place_cameras()  # first: what an upload does makes it known to the shaders
        for number in wanted:
            self._uploaders[number].take_picture()
        for group in self._groups:
            group.take_picture()
        cameras = [{name: one.read() for name, one in of.items()} for of in self._pictures]

        def reader(arrays: Mapping[str, NDArray[Any]], place: int) -> renderer.Read:
            return lambda name: arrays[name][place]

        places = {number: self._drawn.index(number) for number in wanted}
        return {n: [reader(one, place) for one in cameras] for n, place in places.items()}

    def _form(self, numbers: list[int]) -> None:
        """SAPIEN's groups of these scenes."""
        self.__exit__()
        self._drawn, views = numbers, [self._views[number] for number in numbers]
        self._cameras = [camera for _, cameras in views for camera in cameras]
        for camera in self._cameras:
            camera.set_gpu_pose_batch_index(0)  # of poses that nobody asks for
        self._systems = sapien.render.RenderSystemGroup([scene.render_system for scene, _ in views])
        columns = zip(*(cameras for _, cameras in views), strict=True)
        self._groups = [self._systems.create_camera_group([*one], self._names) for one in columns]
        self._pictures = [
            {name: cuda.PinnedArray(group.get_picture_cuda(name)) for name in self._names}
            for group in self._groups
        ]
        self._buffers = [camera._cuda_buffer.ptr for camera in self._cameras]
        self._matrices = np.stack([cuda.read(one, MATRICES) for one in self._buffers])
        self._poses = np.zeros((len(self._cameras), 7), np.float32)

    def _place_cameras(self) -> None:
        """Puts the cameras that have moved where they are now."""
        poses = [camera.global_pose * GL_FROM_SAPIEN for camera in self._cameras]
        now = np.array([(*pose.p, *pose.q) for pose in poses], np.float32)
        moved = np.flatnonzero((now != self._poses).any(axis=1))
        views, inverses = matrices(now[moved, :3], now[moved, 3:])
        self._matrices[moved, :16] = views.reshape(-1, 16)
        self._matrices[moved, -16:] = inverses.reshape(-1, 16)
        for number in moved:
            cuda.write(self._buffers[number], self._matrices[number])
        self._poses = now


@cache
def obstacle() -> str:
    """Why this process cannot draw groups; empty: it can, and did so for a trial to the pixel."""
    device = sapien.Scene().render_system.device
    if not device.is_cuda():
        return f"{device.name} has no CUDA"
    renderer.hold(UPLOADER)
    try:
        wrong = _differences()
    except RuntimeError as error:
        return str(error)
    return f"{wrong} pixels of a trial differ" if wrong else ""


def _differences(rows: int = 4, scenes: int = 3) -> int:
    """Pixels in which groups differ from pictures alone, of boxes and a camera that move."""
    chance, trials = np.random.default_rng(0), [_Trial() for _ in range(scenes)]
    poses = [
        [sapien.Pose(pose[:3] / 2, pose[3:]) for pose in chance.uniform(-1, 1, (2, 7))]
        for _ in range(rows * scenes)
    ]
    shown = [
        list(zip(trials, poses[n : n + scenes], strict=True)) for n in range(0, len(poses), scenes)
    ]
    expected, found = list[NDArray[np.uint8]](), list[NDArray[np.uint8]]()
    for row in shown:
        for trial, (box, eye) in row:
            trial.show(box, eye)
            expected += map(renderer.capture, trial.cameras)
    views = {n: (trial.scene, trial.cameras) for n, trial in enumerate(trials)}
    with CameraGroup(views, renderer.COLOUR) as group:
        for row in shown:
            for trial, (box, eye) in row:
                trial.show(box, eye)
            drawn = group.draw(range(scenes))
            found += [renderer.picture(read) for n in range(scenes) for read in drawn[n]]
    pairs = zip(expected, found, strict=True)
    return sum(int((one != other).any(axis=-1).sum()) for one, other in pairs)


class _Trial:
    """Two boxes, of which one moves, and two cameras, likewise."""

    def __init__(self) -> None:
        self.scene = sapien.Scene()
        renderer.Lights(self.scene)
        self._boxes = [self._box(size) for size in (0.3, 0.1)]
        self.cameras = [self._camera() for _ in range(2)]

    def show(self, box: sapien.Pose, eye: sapien.Pose) -> None:
        self._boxes[0].set_pose(box)
        self.cameras[1].entity.set_pose(eye)
        self.scene.update_render()

    def _box(self, size: float) -> sapien.Entity:
        builder = self.scene.create_actor_builder()
        builder.add_box_visual(half_size=(size, size / 2, size))
        builder.initial_pose = sapien.Pose([0, 0.2, 0.4])
        return builder.build_kinematic()

    def _camera(self) -> Camera:
        camera, mount = Camera(64, 48), sapien.Entity()
        camera.set_fovy(1.0, compute_x=True)
        camera.near, camera.far = 0.1, 100.0
        mount.add_component(camera)
        mount.set_pose(sapien.Pose([-1.0, 0, 0]))
        self.scene.add_entity(mount)
        return camera


def _uploader(camera: Camera) -> Camera:
    """A camera whose picture nobody needs: taking it uploads the poses of the scene's shapes."""
    uploader = Camera(16, 16, UPLOADER)
    uploader.near, uploader.far = 0.1, 100.0
    camera.entity.add_component(uploader)
    return uploader


def matrices(
    p: NDArray[np.float32], q: NDArray[np.float32]
) -> tuple[NDArray[np.float32], NDArray[np.float32]]:
    """View matrices (N, 4, 4) of cameras in OpenGL's axes, and their inverses, by columns.

    `p` (N, 3) [m] and `q` (N, 4) wxyz in the world. The order of the operations is that of GLM's
    `toMat4` and `affineInverse`, by which SAPIEN rounds.
    """
    w, x, y, z = q.T
    one, two = np.float32(1), np.float32(2)
    a, b, c = one - two * (y * y + z * z), two * (x * y + w * z), two * (x * z - w * y)
    d, e, f = two * (x * y - w * z), one - two * (x * x + z * z), two * (y * z + w * x)
    g, h, i = two * (x * z + w * y), two * (y * z - w * x), one - two * (x * x + y * y)
    s = one / (a * (e * i - h * f) - d * (b * i - h * c) + g * (b * f - e * c))
    first = np.stack([(e * i - h * f) * s, -(b * i - h * c) * s, (b * f - e * c) * s])
    second = np.stack([-(d * i - g * f) * s, (a * i - g * c) * s, -(a * f - d * c) * s])
    third = np.stack([(d * h - g * e) * s, -(a * h - g * b) * s, (a * e - d * b) * s])
    last = -first * p[:, 0] + -second * p[:, 1] + -third * p[:, 2]
    inverse, view = np.tile(np.eye(4, dtype=np.float32), (2, len(p), 1, 1))
    inverse[:, :3, :3] = np.array([[a, b, c], [d, e, f], [g, h, i]]).transpose(2, 0, 1)
    inverse[:, 3, :3] = p
    view[:, :, :3] = np.array([first, second, third, last]).transpose(2, 0, 1)
    return view, inverse
