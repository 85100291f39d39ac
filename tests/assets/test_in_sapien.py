"""Every model in the simulator: its parts cook, and what should stand stands."""

import numpy as np
import pytest
from every_model import ARTICULATED, RIGID, made

from rtphys.assets.asset_model import AssetModel
from rtphys.assets.model import Model
from rtphys.core.poses import Pose

pytestmark = pytest.mark.sim
sapien = pytest.importorskip("sapien")

from rtphys.sim.urdf import build_articulation  # noqa: E402

UPRIGHT = (0.70710678, 0.70710678, 0, 0)  # y up to z up


def scene():
    new = sapien.Scene([sapien.physx.PhysxCpuSystem()])
    new.set_timestep(1 / 250)
    new.add_ground(0.0, render=False)
    return new


def put(world, model: Model, height: float):
    builder = world.create_actor_builder()
    builder.add_multiple_convex_collisions_from_file(
        str(model.collision), scale=list(model.scale), density=model.density
    )
    builder.initial_pose = sapien.Pose((0, 0, height), UPRIGHT)
    entity = builder.build()
    body = entity.find_component_by_type(sapien.physx.PhysxRigidDynamicComponent)
    weigh(body, model)
    return entity, body


def weigh(body, model: Model) -> None:
    assert model.mass_kg and model.inertia is not None and model.center_of_mass is not None
    ratio = model.mass_kg / body.mass
    inertia = np.array(body.inertia)
    body.set_mass(model.mass_kg)
    body.set_inertia(inertia * ratio)
    frame = body.cmass_local_pose
    body.set_cmass_local_pose(sapien.Pose(model.center_of_mass, frame.q))


@pytest.mark.parametrize(("name", "index"), RIGID, ids=lambda v: str(v))
def test_all_parts_cook_and_upright_models_rest(builtin, name, index):
    model, world = builtin.model(name, index), scene()
    bottom = model.center[1] - model.extents[1] / 2
    entity, body = put(world, model, 0.01 - bottom)
    drawn = made(name, index)
    assert isinstance(drawn, AssetModel)
    assert len(body.collision_shapes) == len(drawn.body.collision)
    if not model.stable:
        return
    for _ in range(500):
        world.step()
    up = entity.pose.to_transformation_matrix()[:3, 1]
    assert np.rad2deg(np.arccos(np.clip(up[2], -1, 1))) < 3
    assert np.linalg.norm(entity.pose.p[:2]) < 0.01
    assert np.linalg.norm(body.linear_velocity) < 0.005


@pytest.mark.parametrize(("name", "index"), ARTICULATED, ids=lambda v: str(v))
def test_articulations_load_with_joints_limits_and_masses(builtin, name, index):
    asset, world = builtin.articulation(name, index), scene()
    machine = build_articulation(world, asset.urdf, Pose(), asset.scale)
    names = {link.name for link in machine.links}
    assert {p.link for p in asset.contact_points + asset.functional_points} <= names
    assert set(asset.balanced_links) <= names
    assert machine.dof >= 1 and np.all(machine.qlimits[:, 1] > machine.qlimits[:, 0])
    assert sum(link.mass for link in machine.links) == pytest.approx(asset.mass_kg, rel=1e-3)
