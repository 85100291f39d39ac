"""Rest is judged by where bodies are, 20 ms apart, and not by the solver's velocities."""

import numpy as np
import pytest
from sapien import physx

from rtphys.assets.pack import default_pack
from rtphys.episode.generate import prepare
from rtphys.physics import Physics
from rtphys.sim.engine import TIME_STEP
from rtphys.sim.motion import STRIDE, rows_of
from rtphys.sim.view import SceneView
from rtphys.sim.world import World
from rtphys.spec.episode import EpisodeSpec
from rtphys.task import load_task

pytestmark = pytest.mark.sim


def world_of(task: str) -> tuple[World, Physics]:
    instance = prepare(EpisodeSpec(task, "clean").at(1), load_task(task), default_pack())
    instance.world.settle()
    return instance.world, instance.physics


def test_a_velocity_that_moves_nothing_is_rest() -> None:
    """What the solver says of a body at the end of a step need not be how it moves."""
    world, physics = world_of("place_empty_cup")
    scene, cup = SceneView(world, physics), world.object("cup").root
    assert isinstance(cup, physx.PhysxRigidDynamicComponent)
    for _ in range(2 * STRIDE):
        world.step()
    cup.set_linear_velocity([0.5, 0.0, 0.0])  # pyright: ignore[reportArgumentType]
    assert np.linalg.norm(cup.linear_velocity) > 0.4
    assert scene.speed("cup") < 1e-3
    cup.set_linear_velocity([0.0, 0.0, 0.0])  # pyright: ignore[reportArgumentType]


def test_what_moves_has_the_speed_of_its_centre_of_mass() -> None:
    world, physics = world_of("place_empty_cup")
    scene, cup = SceneView(world, physics), world.object("cup").root
    assert isinstance(cup, physx.PhysxRigidDynamicComponent)
    pose = cup.entity_pose
    pose.set_p([0.0, 0.0, 2.0])
    cup.entity.set_pose(pose)
    cup.set_linear_velocity([0.0, 0.3, 0.0])  # pyright: ignore[reportArgumentType]
    cup.set_angular_velocity([3.0, 0.0, 0.0])  # pyright: ignore[reportArgumentType]
    rows = rows_of(world.object("cup").bodies, world.rows)
    for step in range(1, 3 * STRIDE + 1):
        world.step()
        if step < 2 * STRIDE:
            continue
        age = (STRIDE + world.steps % STRIDE) * TIME_STEP  # of the poses that are compared
        fallen = -9.81 * (step * TIME_STEP - age / 2)
        assert scene.speed("cup") == pytest.approx(np.hypot(0.3, fallen), rel=0.05)
        (_, spin), *_ = world.speeds(rows)
        assert spin == pytest.approx(3.0, rel=0.02)


def test_a_world_settles_though_its_solver_reports_a_velocity() -> None:
    world, _ = world_of("place_empty_cup")
    cup, start = world.object("cup").root, world.steps
    assert isinstance(cup, physx.PhysxRigidDynamicComponent)
    world.on_step("false", after=lambda: cup.set_angular_velocity([0.0, 0.0, 0.2]))  # pyright: ignore[reportArgumentType]
    world.on_step("held", before=lambda: cup.set_angular_velocity([0.0, 0.0, 0.0]))  # pyright: ignore[reportArgumentType]
    world.settle()
    assert world.steps - start == 50
