"""Groups of cameras on a GPU: the matrices they are given, and the trial that must come first."""

from collections.abc import Callable, Iterable, Mapping, Sequence
from typing import Any, Self

import numpy as np
import pytest
import sapien

from rtphys.sim import camera_group, cuda, renderer
from rtphys.sim.camera_group import Camera, matrices


class Alone:
    """Draws each camera for itself, as on a CPU."""

    def __init__(
        self, views: Mapping[int, tuple[sapien.Scene, Sequence[Camera]]], names: Sequence[str]
    ) -> None:
        self.views = {number: cameras for number, (_, cameras) in views.items()}

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *error: object) -> None: ...

    def draw(self, numbers: Iterable[int]) -> dict[int, list[renderer.Read]]:
        for camera in (camera for number in numbers for camera in self.views[number]):
            camera.take_picture()
        return {n: [camera.get_picture for camera in self.views[n]] for n in numbers}


class Late(Alone):
    """Gives the pictures of the row before."""

    def draw(self, numbers: Iterable[int]) -> dict[int, list[renderer.Read]]:
        def read(number: int, camera: int) -> renderer.Read:
            return lambda name: before[number][camera]

        now = super().draw(numbers)
        pictures = {n: [np.array(read("Color")) for read in reads] for n, reads in now.items()}
        before, self.before = getattr(self, "before", pictures), pictures
        return {n: [read(n, camera) for camera in range(2)] for n in numbers}


class Rounded(Alone):
    """One value of one pixel of the last scene is off by one."""

    def draw(self, numbers: Iterable[int]) -> dict[int, list[renderer.Read]]:
        def wrong(read: renderer.Read) -> renderer.Read:
            def picture(name: str) -> Any:
                seen = np.array(read(name))
                seen[0, 0, 0] ^= 1
                return seen

            return picture

        reads = super().draw(numbers)
        reads[max(reads)][0] = wrong(reads[max(reads)][0])
        return reads


@pytest.mark.render
@pytest.mark.parametrize("kind, low, high", [(Alone, 0, 0), (Late, 1000, 10**6), (Rounded, 4, 4)])
def test_the_trial_counts_every_pixel_that_is_not_the_one_drawn_alone(
    kind: Callable[..., Alone], low: int, high: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    renderer.ready()
    monkeypatch.setattr(camera_group, "CameraGroup", kind)
    assert low <= camera_group._differences() <= high


@pytest.mark.render
def test_where_nothing_has_cuda_pictures_are_drawn_alone() -> None:
    renderer.ready()
    device = sapien.Scene().render_system.device
    if device.is_cuda():
        assert camera_group.obstacle() == ""
    else:
        assert camera_group.obstacle() == f"{device.name} has no CUDA"


def test_matrices_are_those_of_the_pose_and_do_not_depend_on_the_others() -> None:
    chance = np.random.default_rng(2)
    q = chance.normal(size=(50, 4))
    q = (q / np.linalg.norm(q, axis=1, keepdims=True)).astype(np.float32)
    p = chance.normal(size=(50, 3)).astype(np.float32)
    views, inverses = matrices(p, q)
    for n in range(len(p)):
        expected = sapien.Pose(p[n], q[n]).to_transformation_matrix()
        assert np.allclose(inverses[n].T, expected, atol=1e-6)
        assert np.allclose(views[n].T @ expected, np.eye(4), atol=2e-6)
        one, other = matrices(p[n : n + 1], q[n : n + 1])
        assert (one == views[n]).all() and (other == inverses[n]).all()


def test_a_machine_without_the_driver_says_so(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(cuda, "LIBRARY", "libcuda-of-nobody")
    cuda._library.cache_clear()
    with pytest.raises(cuda.NoCuda, match="libcuda-of-nobody"):
        cuda.read(0, 1)
