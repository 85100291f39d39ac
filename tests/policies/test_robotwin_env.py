"""TASK_ENV to the letter: observations, members and actions as RoboTwin's adapters use them."""

from typing import Any

import numpy as np
import pytest

from rtphys.assets.pack import default_pack
from rtphys.episode import PolicyEpisode, begin
from rtphys.episode.observation import Mirror
from rtphys.policies.robotwin_env import TaskEnv
from rtphys.spec.episode import EpisodeSpec
from rtphys.spec.recording import RecordingSpec
from rtphys.task.spec import load_task

pytestmark = pytest.mark.sim


def test_the_observation_to_the_letter(episode: PolicyEpisode) -> None:
    env = TaskEnv()
    env.begin_episode(episode)
    found: Any = env.get_obs()
    assert list(found) == ["observation", "pointcloud", "joint_action", "endpose"]
    assert found["pointcloud"] == []
    assert set(found["observation"]) == {"head_camera", "left_camera", "right_camera"}
    head = found["observation"]["head_camera"]
    matrices = {"intrinsic_cv": (3, 3), "extrinsic_cv": (3, 4), "cam2world_gl": (4, 4)}
    assert {k: value.shape for k, value in head.items()} == {"rgb": (240, 320, 3), **matrices}
    joints, ends = found["joint_action"], found["endpose"]
    for side in ("left", "right"):
        assert type(joints[f"{side}_arm"]) is list and len(joints[f"{side}_arm"]) == 6
        assert type(joints[f"{side}_gripper"]) is float
        assert joints[f"{side}_gripper"] == ends[f"{side}_gripper"] == 1.0
        assert type(ends[f"{side}_endpose"]) is list
        assert np.linalg.norm(ends[f"{side}_endpose"][3:]) == pytest.approx(1)
    parts = [joints["left_arm"], [1.0], joints["right_arm"], [1.0]]
    assert joints["vector"].tolist() == [x for part in parts for x in part]
    # What an adapter does to its copy is its own affair.
    head["rgb"][:] = 0
    kept: Any = env.now_obs
    assert kept["observation"]["head_camera"]["rgb"].any()


def test_the_members_that_adapters_use(episode: PolicyEpisode) -> None:
    env = TaskEnv()
    with pytest.raises(RuntimeError, match="setup_demo"):
        env.get_obs()
    env.begin_episode(episode)
    env._fact_force_full_obs = True  # type: ignore[attr-defined] - adapters hang things on it
    assert env.task_name == "click_bell"
    assert getattr(env, "seed", None) == 0
    left, right = env.robot.get_left_arm_jointState(), env.robot.get_right_arm_jointState()
    assert left + right == episode.observe().vector.tolist()
    assert env.robot.get_left_gripper_val() == 1.0
    assert env.robot.is_left_gripper_open()
    assert not env.robot.is_right_gripper_close()
    ee, tcp = np.array(env.robot.get_left_ee_pose()), np.array(env.robot.get_left_tcp_pose())
    assert np.linalg.norm(ee[:3] - tcp[:3]) == pytest.approx(0.12, abs=1e-6)
    cameras = env.robot.left_camera, env.robot.right_camera
    env.cameras.update_wrist_camera(*(camera.get_pose() for camera in cameras))
    env.cameras.update_picture()
    assert env.cameras.get_rgb()["left_camera"]["rgb"][0, 0, 0] == 20
    assert "cam2world_gl" in env.cameras.get_config()["head_camera"]


def test_actions_of_every_kind_and_none_after_the_end(episode: PolicyEpisode) -> None:
    env = TaskEnv()
    env.begin_episode(episode)
    env.take_action(left_up := [*env.robot.get_left_arm_jointState()] * 2, action_type="qpos")
    poses = [env.robot.get_left_ee_pose(), env.robot.get_right_ee_pose()]
    env.take_action([*poses[0], 1.0, *poses[1], 1.0], action_type="ee")
    still = [0, 0, 0, 1, 0, 0, 0, 1]
    env.take_action([*still, *still], "delta_ee")
    assert env.take_action_cnt == episode.taken == 3
    env.step_lim = 3
    env.take_action(left_up)
    assert episode.taken == 3
    env.step_lim, env.eval_success = 100, True
    env.take_action(left_up)
    assert env.take_action_cnt == 3


def not_drawn(*_: object) -> None:
    raise AssertionError("a picture was drawn")


def test_touch_is_felt_and_draws_nothing(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(Mirror, "view", not_drawn)
    env, task, asked = TaskEnv(), load_task("click_bell"), RecordingSpec(senses=("touch",))
    env.begin_episode(begin(EpisodeSpec("click_bell").at(0), task, default_pack(), asked))
    env.data_type["rgb"] = False
    env.take_action(env.get_obs()["joint_action"]["vector"])
    felt = env.get_obs()["touch"]
    assert felt["force"].shape == (4, 3) and felt["margin"].shape == (4,)
    assert len(felt["fingers"]) == 4 and np.isfinite(felt["normal"]).all()


def test_without_rgb_nothing_is_drawn(
    episode: PolicyEpisode, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(Mirror, "view", not_drawn)
    env = TaskEnv()
    env.begin_episode(episode)
    env.data_type["rgb"] = False
    assert env.get_obs()["observation"] == {}
