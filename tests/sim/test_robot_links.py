"""The robot in the simulator: fewer links, the same shapes; contact only where it can matter."""

import numpy as np
import pytest
from sapien import physx

from rtphys.assets.embodiment import Embodiment
from rtphys.assets.pack import default_pack
from rtphys.core.poses import Array
from rtphys.sim.body import shape_points
from rtphys.sim.engine import new_scene
from rtphys.sim.robot import SimRobot
from rtphys.sim.urdf import build_articulation, build_robot

pytestmark = pytest.mark.sim


@pytest.fixture(scope="module")
def embodiment() -> Embodiment:
    return default_pack().embodiment()


@pytest.fixture
def robot(embodiment: Embodiment) -> SimRobot:
    return SimRobot(new_scene(visuals=False), embodiment)


def vertices(robot: physx.PhysxArticulation) -> Array:
    """Collision vertices (n, 3) in the world at a bent posture, in an order of their own."""
    robot.set_qpos(np.linspace(0.1, 0.3, robot.dof).astype(np.float32))
    points = []
    for link in robot.links:
        X = link.entity_pose.to_transformation_matrix()
        points += [shape_points(s) @ X[:3, :3].T + X[:3, 3] for s in link.collision_shapes]
    found = np.vstack(points)
    return found[np.lexsort(found.round(4).T)]


def test_folding_moves_no_shape(embodiment: Embodiment) -> None:
    scenes = [new_scene(visuals=False), new_scene(visuals=False)]
    whole = build_articulation(scenes[0], embodiment.urdf, embodiment.base)
    folded = build_robot(scenes[1], embodiment.urdf, embodiment.base)
    assert len(folded.links) < len(whole.links)
    assert [j.name for j in folded.active_joints] == [j.name for j in whole.active_joints]
    a, b = vertices(whole), vertices(folded)
    assert a.shape == b.shape
    # Rounding may swap rows that share a coordinate: compare each column by itself.
    assert np.allclose(np.sort(a, axis=0), np.sort(b, axis=0), atol=1e-5)


def collide(
    a: physx.PhysxArticulationLinkComponent, b: physx.PhysxArticulationLinkComponent
) -> bool:
    """Whether some shape of one may touch some shape of the other."""
    words = [[s.get_collision_groups()[2] for s in link.collision_shapes] for link in (a, b)]
    return any(not x & y for x in words[0] for y in words[1])


def test_hands_touch_each_other_and_the_arm_but_no_arm_touches_itself(robot: SimRobot) -> None:
    left, right = robot.left, robot.right
    hand = left.finger_links[0]
    assert collide(hand, right.finger_links[0])
    assert collide(hand, right.links[2])
    assert collide(hand, left.links[1])
    assert collide(hand, robot.articulation.root)
    assert collide(left.links[2], right.links[2])
    assert not collide(left.links[1], left.links[3])
    assert not collide(hand, left.finger_links[1])


def test_closed_fingers_are_stopped_by_their_joint_limits(robot: SimRobot) -> None:
    robot.left.grip(0.0)
    for _ in range(500):
        robot.scene.step()
    assert robot.left.gap() == pytest.approx(0.0, abs=1e-3)
