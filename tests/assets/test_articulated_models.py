"""Switch, microwave and cabinet in the simulator: they stay put, move when pushed, hold objects."""

import numpy as np
import pytest

from rtphys.assets.build import build
from rtphys.assets.pack import Pack
from rtphys.core.poses import Pose

pytestmark = pytest.mark.sim
sapien = pytest.importorskip("sapien")

from rtphys.sim.urdf import build_articulation  # noqa: E402

MACHINES = [("056_switch", i) for i in range(8)]
MACHINES += [("044_microwave", 0), ("044_microwave", 1), ("036_cabinet", 46653)]
FORCE = {"056_switch": 5.0, "044_microwave": 4.0, "036_cabinet": 5.0}  # [N]


@pytest.fixture(scope="module")
def pack(tmp_path_factory):
    names = ["056_switch", "044_microwave", "036_cabinet", "112_tea-box", "077_phone"]
    return Pack(build(tmp_path_factory.mktemp("machines") / "pack", names=names, workers=1))


def stood_up(pack, name, index):
    """A scene with the model fixed in it, its front towards -y, as nominal physics has it."""
    scene = sapien.Scene([sapien.physx.PhysxCpuSystem()])
    scene.set_timestep(1 / 250)
    asset = pack.articulation(name, index)
    articulation = build_articulation(scene, asset.urdf, Pose(), asset.scale)
    height = float(asset.root_offset[2, 3]) + 0.3
    articulation.set_root_pose(sapien.Pose([0, 0, height], [0.70710678, 0, 0, 0.70710678]))
    for joint in articulation.active_joints:
        joint.set_drive_properties(0.0, asset.joint_damping)
    for link in articulation.links:
        link.disable_gravity = link.name in asset.balanced_links
    return scene, asset, articulation


def link_frame(articulation, name):
    link = next(link for link in articulation.links if link.name == name)
    return link, link.entity_pose.to_transformation_matrix()


@pytest.mark.parametrize(("name", "index"), MACHINES)
def test_nothing_moves_by_itself(pack, name, index):
    scene, _, articulation = stood_up(pack, name, index)
    for _ in range(500):
        scene.step()
    np.testing.assert_allclose(articulation.qpos, 0, atol=1e-3)


@pytest.mark.parametrize(("name", "index"), MACHINES)
def test_a_few_newtons_at_the_contact_point_move_it_to_its_limit(pack, name, index):
    scene, asset, articulation = stood_up(pack, name, index)
    point = asset.contact_points[0]
    for _ in range(750):
        link, X = link_frame(articulation, point.link)
        p = (X @ point.matrix)[:3, 3]
        # A rocker is pushed in, against the point's outward y; doors and drawers are pulled out.
        push = -(X @ point.matrix)[:3, 1] if name == "056_switch" else X[:3, 2]
        link.add_force_at_point(list(FORCE[name] * push), list(p))
        scene.step()
    assert articulation.qpos[0] == pytest.approx(articulation.qlimits[0, 1], abs=0.01)
    np.testing.assert_allclose(articulation.qpos[1:], 0, atol=1e-3)


@pytest.mark.parametrize("dropped", [("112_tea-box", 0), ("077_phone", 3)])
def test_the_pulled_drawer_holds_what_is_dropped_into_it(pack, dropped):
    scene, asset, articulation = stood_up(pack, "036_cabinet", 46653)
    q = articulation.qpos
    q[0] = 0.16
    articulation.set_qpos(q)
    point = asset.functional_points[0]
    floor = (link_frame(articulation, point.link)[1] @ point.matrix)[:3, 3]
    model = pack.model(*dropped)
    builder = scene.create_actor_builder()
    builder.add_multiple_convex_collisions_from_file(str(model.collision), density=model.density)
    above = [floor[0], floor[1], floor[2] + 0.06]
    builder.initial_pose = sapien.Pose(above, [0.70710678, 0.70710678, 0, 0])
    entity = builder.build()
    for _ in range(500):
        scene.step()
    now = (link_frame(articulation, point.link)[1] @ point.matrix)[:3, 3]
    off = entity.pose.p - now
    assert np.abs(off[:2]).max() < 0.03 and 0 <= off[2] + 0.001 < 0.03


@pytest.mark.parametrize("stand", [1, 2])
def test_a_phone_leans_in_its_stand(tmp_path, stand):
    pack = Pack(build(tmp_path / "pack", names=["077_phone", "078_phonestand"], workers=1))
    scene = sapien.Scene([sapien.physx.PhysxCpuSystem()])
    scene.set_timestep(1 / 250)
    up = np.array([[1, 0, 0, 0], [0, 0, -1, 0], [0, 1, 0, 0], [0, 0, 0, 1.0]])
    holder, phone = pack.model("078_phonestand", stand), pack.model("077_phone", 1)
    cradle = up @ holder.functional_points[0]
    builder = scene.create_actor_builder()
    builder.add_multiple_convex_collisions_from_file(str(holder.collision))
    builder.initial_pose = sapien.Pose(up)
    builder.build_static()
    start = cradle @ np.linalg.inv(phone.functional_points[0])
    start[:3, 3] += 0.002 * cradle[:3, 0] + 0.002 * cradle[:3, 2]
    builder = scene.create_actor_builder()
    builder.add_multiple_convex_collisions_from_file(str(phone.collision), density=phone.density)
    builder.initial_pose = sapien.Pose(start)
    entity = builder.build()
    for _ in range(750):
        scene.step()
    now = entity.pose.to_transformation_matrix() @ phone.functional_points[0]
    assert np.abs(now[:3, 3] - cradle[:3, 3]).max() < 0.015
    assert now[:3, 2] @ cradle[:3, 2] > np.cos(np.radians(15))
