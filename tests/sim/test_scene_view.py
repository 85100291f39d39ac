"""A value of poses is worked out again when one of them has changed, and only then."""

from types import SimpleNamespace
from typing import Any, cast

import numpy as np
import pytest

from rtphys.assets.pack import default_pack
from rtphys.core.errors import UnknownName
from rtphys.episode.generate import prepare
from rtphys.sim.engine import AnyBody
from rtphys.sim.view import PosesNow, SceneView
from rtphys.sim.world import World
from rtphys.spec.episode import EpisodeSpec
from rtphys.task import load_task
from rtphys.task.arm import Placing

FIRST, SECOND = cast(AnyBody, "first"), cast(AnyBody, "second")


class Poses:
    """A world of two bodies, one byte each."""

    def __init__(self) -> None:
        self.steps, self.bytes, self.reads = 0, [1, 1], 0
        self.scene: Any = SimpleNamespace(pack_poses=self._pack)
        self.rows: Any = SimpleNamespace(
            bytes_of=lambda body: slice(0, 1) if body is FIRST else slice(1, 2)
        )

    def _pack(self) -> bytes:
        self.reads += 1
        return bytes(self.bytes)

    def step(self, first: int, second: int) -> None:
        self.steps += 1
        self.bytes = [first, second]


def test_only_a_body_that_it_follows_makes_it_anew() -> None:
    world = Poses()
    made: list[int] = []

    def work_out() -> int:
        made.append(world.steps)
        return world.bytes[0]

    value = PosesNow(cast(World, world)).follow([FIRST], work_out)
    assert (value(), value(), made) == (1, 1, [0])
    world.step(1, 7)
    assert (value(), made) == (1, [0])
    world.step(2, 7)
    assert (value(), made) == (2, [0, 2])
    world.step(1, 7)
    assert (value(), made) == (1, [0, 2, 3])


def test_all_values_share_one_read_a_step() -> None:
    world = Poses()
    poses = PosesNow(cast(World, world))
    values = [poses.follow([FIRST, SECOND], lambda: sum(world.bytes)) for _ in range(3)]
    for first, second in ((1, 2), (4, 2), (4, 2), (4, 9)):
        world.step(first, second)
        assert [value() for value in values] == [first + second] * 3
    assert world.reads == 4


@pytest.mark.sim
def test_the_top_of_a_box_is_its_own_point_there_whatever_its_size_and_the_tables_tilt() -> None:
    physics = {"object_scale": 1.2, "table_tilt": 0.05}
    spec = EpisodeSpec("stack_blocks_two", "clean", overrides=physics)
    instance = prepare(spec.at(1), load_task(spec.task), default_pack())
    instance.world.settle()
    scene = SceneView(instance.world, instance.physics)
    top = scene.on_top("red")
    assert top.p == pytest.approx(scene.functional("red", 1).p, abs=1e-3)  # its point has z down
    assert abs(top.R - np.eye(3)).max() < 1e-9


@pytest.mark.sim
def test_contacts_of_a_misspelt_name_are_refused() -> None:
    """They are none, ever, so `free_of` held whatever happened."""
    instance = prepare(EpisodeSpec("click_bell").at(0), load_task("click_bell"), default_pack())
    view = SceneView(instance.world, instance.physics)
    assert not view.touching("bell", "left_gripper")
    for ask in (view.touching, view.contact_points, view.impulse):
        with pytest.raises(UnknownName, match="'bel'; did you mean 'bell'"):
            ask("left_gripper", "bel")


def test_a_placing_knows_its_words() -> None:
    with pytest.raises(UnknownName, match="'algin'; did you mean 'align'"):
        Placing(mode="algin")
    with pytest.raises(UnknownName, match="'pont'; did you mean 'point'"):
        Placing(along="pont")
