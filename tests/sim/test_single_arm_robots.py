"""Robots of two single arms in the simulator: frames, fingers, and an episode of each."""

from dataclasses import replace

import numpy as np
import pytest

from rtphys.assets.pack import builtin_pack
from rtphys.core.seeds import stream
from rtphys.episode.control import actions_of, replay
from rtphys.episode.generate import attempt
from rtphys.plan.collision import CollisionChecker
from rtphys.plan.kinematics import arm_kinematics, check_robot
from rtphys.sim.engine import new_scene
from rtphys.sim.robot import SimRobot
from rtphys.spec.episode import EpisodeSpec
from rtphys.spec.stored import stored
from rtphys.task.spec import load_task

pytestmark = pytest.mark.sim
PACK = builtin_pack()
SIZES = {"franka-panda": 16, "piper": 14, "piper,piper,0.7": 14, "piper,franka-panda,0.7": 15}


@pytest.fixture(params=["franka-panda", "piper", "piper,franka-panda,0.7"])
def name(request: pytest.FixtureRequest) -> str:
    return request.param


def test_simulator_and_planner_agree_on_the_hand(name: str) -> None:
    robot = check_robot(PACK, name)
    simulated = SimRobot(new_scene(visuals=False), robot)
    assert len(simulated.articulation.links) == 1 + sum(n + 2 for n in robot.action_layout.per_arm)
    kinematics = arm_kinematics(robot)
    rng = np.random.default_rng(0)
    for _ in range(3):
        qpos = np.array(simulated.articulation.qpos)
        for arm in simulated.arms:
            qpos[arm.index] = rng.uniform(*arm.limb.limits.T)
        simulated.articulation.set_qpos(qpos.astype(np.float32))
        for arm in simulated.arms:
            planned = kinematics[arm.side].ee_pose(arm.measured())
            np.testing.assert_allclose(arm.ee().p, planned.p, atol=2e-5)
            assert arm.ee().angle_to(planned) < 1e-3


def test_at_home_the_hands_are_open_and_nothing_touches(name: str) -> None:
    robot = PACK.embodiment(name)
    simulated = SimRobot(new_scene(visuals=False), robot)
    for _ in range(50):
        simulated.scene.step()
    for arm in simulated.arms:
        assert arm.opening() == pytest.approx(1.0, abs=0.01)
        np.testing.assert_allclose(arm.measured(), arm.limb.home, atol=1e-3)
    assert CollisionChecker(robot).clear(robot.left.home, robot.right.home)
    assert not simulated.scene.get_contacts()


def test_what_presses_a_finger_outwards_is_positive_whichever_way_its_joint_counts() -> None:
    robot = PACK.embodiment("piper")
    turned = replace(robot, left=replace(robot.left, finger_signs=(1.0, -1.0)))
    usual, other = (SimRobot(new_scene(visuals=False), one) for one in (robot, turned))
    forces = np.random.default_rng(0).normal(size=(len(usual.articulation.links), 6))
    ratio = other.effort_of(forces) / usual.effort_of(forces)
    assert np.flatnonzero(ratio == -1).tolist() == [usual.left.finger_index[1]]
    assert (ratio == 1).sum() == len(ratio) - 1


@pytest.mark.parametrize("name", ["aloha-agilex", "franka-panda", "piper"])
def test_closed_fingers_are_stopped_in_the_middle_by_their_joint_limits(name: str) -> None:
    simulated = SimRobot(new_scene(visuals=False), PACK.embodiment(name))
    simulated.left.grip(0.0)
    for _ in range(500):
        simulated.scene.step()
    assert simulated.left.gap() == pytest.approx(0.0, abs=1e-3)


def test_spare_joints_lean_to_the_bent_posture() -> None:
    robot = PACK.embodiment("franka-panda")
    left = arm_kinematics(robot)["left"]
    twisted = robot.left.bent + np.array([0.3, 0.2, 0.8, 0.1, -0.5, -0.3, 0.4])
    goal = left.ee_pose(robot.left.bent).moved((0.02, 0.0, 0.0))
    found = left.solve_near(goal, twisted, stream(0, "test"))
    assert found is not None
    assert left.ee_pose(found).angle_to(goal) < 2e-3
    np.testing.assert_allclose(left.ee_pose(found).p, goal.p, atol=2e-4)
    # Without the lean the elbow would stay where the search began, 0.8 rad away.
    away = [np.linalg.norm((q - robot.left.bent) * robot.left.weights) for q in (found, twisted)]
    assert away[0] < 0.7 * away[1]
    assert (robot.left.limits[:, 0] <= found).all() and (found <= robot.left.limits[:, 1]).all()


@pytest.mark.parametrize("name", SIZES)
def test_the_expert_rings_the_bell_and_its_actions_do_again(name: str) -> None:
    task = load_task("click_bell")
    recipe = EpisodeSpec("click_bell", "clean", embodiment=name).at(0)
    done, again = (attempt(recipe, task, PACK) for _ in range(2))
    assert done.accepted, done.detail
    assert done.recording is not None and again.recording is not None
    assert done.recording.hash == again.recording.hash
    actions = actions_of(done.recording)
    assert actions.shape[1] == SIZES[name]
    assert replay(recipe, task, PACK, actions)
    assert stored(recipe)["spec"]["embodiment"] == name  # type: ignore[index]


def test_a_hand_with_little_room_before_its_palm_closes_on_a_thin_thing_not_above_it() -> None:
    spec = EpisodeSpec("move_playingcard_away", protocol="clean", embodiment="franka-panda")
    done = attempt(spec.at(0), load_task(spec.task), PACK)
    assert (done.reason, done.detail) == ("", "")
