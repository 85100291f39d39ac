"""The tasks as Gymnasium environments."""
# Gymnasium types what nested observations hold as objects.
# pyright: reportIndexIssue=false, reportArgumentType=false
# pyright: reportCallIssue=false, reportAttributeAccessIssue=false

import subprocess
import sys
import warnings
from pathlib import Path

import gymnasium
import numpy as np
import pytest
from gymnasium import spaces
from gymnasium.utils.env_checker import check_env
from gymnasium.vector import AsyncVectorEnv, SyncVectorEnv

from rtphys.assets.pack import default_pack
from rtphys.core import library
from rtphys.core.errors import BadValue, Infeasible, UnknownName
from rtphys.episode.control import actions_of
from rtphys.episode.generate import attempt
from rtphys.episode.policy_episode import PolicyEpisode, begin
from rtphys.gym import FlatObservation, env_id, register_all
from rtphys.gym import env as env_module
from rtphys.gym.env import TaskEnv
from rtphys.physics import attributes
from rtphys.spec.episode import EpisodeSpec, Recipe
from rtphys.task.spec import load_task

pytestmark = pytest.mark.sim
BELL = "rtphys/click_bell-v0"


def test_every_task_is_registered() -> None:
    known = {key for key in gymnasium.registry if key.startswith("rtphys/")}
    assert known == {f"rtphys/{task}-v0" for task in library.names("tasks", None)}


def test_a_name_that_gymnasium_does_not_allow_hides_no_other_task(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "tasks").mkdir()
    for name in ("my bell", "my-bell"):
        (tmp_path / "tasks" / f"{name}.py").touch()
    monkeypatch.setenv("RTPHYS_LIBRARY", str(tmp_path))
    monkeypatch.setattr(gymnasium.envs.registration, "registry", {})
    monkeypatch.setattr(gymnasium, "registry", known := gymnasium.envs.registration.registry)
    register_all()
    own = set(library.names("tasks", None)) - {"my bell"}
    assert "my-bell" in own and {*known} == {env_id(name) for name in own}


def test_a_held_value_that_changes_nothing_is_warned_of() -> None:
    env = TaskEnv("heavy_below", physics={"object_mass": 2.0})
    with pytest.warns(UserWarning, match="object_mass could not act in heavy_below: every object"):
        env.reset(seed=0)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        env.reset(seed=0, options={"physics": {"object_mass@first": 2.0, "friction": 0.4}})


@pytest.mark.parametrize("task", ["click_bell", "open_laptop"])
@pytest.mark.parametrize("show_physics", [False, True])
def test_gymnasiums_own_check(task: str, show_physics: bool) -> None:
    env = TaskEnv(task, "phys_random", show_physics=show_physics)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        # Real joint limits are no unit interval, poses have no bounds; both are notes, not errors.
        warnings.filterwarnings("ignore", message=".*(symmetric and normalized|infinity).*")
        warnings.filterwarnings("ignore", message=".*spec.*")
        check_env(env, skip_render_check=True)


@pytest.mark.render
@pytest.mark.slow
def test_gymnasiums_own_check_with_pictures() -> None:
    check_env(gymnasium.make(BELL, obs="pixels", render_mode="rgb_array").unwrapped)


def test_an_id_can_name_its_module() -> None:
    code = "import gymnasium; print(gymnasium.make('rtphys.gym:rtphys/click_bell-v0').spec.id)"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True)
    assert done.stdout.strip() == BELL, done.stderr


@pytest.mark.render
def test_pictures() -> None:
    env = gymnasium.make(BELL, obs="pixels", render_mode="rgb_array")
    seen, _ = env.reset(seed=1)
    assert set(seen) == {"agent_pos", "pixels"}
    assert set(seen["pixels"]) == {"head", "left", "right"}
    assert all(view.std() > 5 for view in seen["pixels"].values())
    np.testing.assert_array_equal(env.render(), seen["pixels"]["head"])
    env.close()


def test_tracked_actions_all_last_a_frame() -> None:
    env = TaskEnv("click_bell", control="tracking")
    seen, info = env.reset(seed=0)
    times = [info["time"]]
    target = np.array(seen["agent_pos"])
    target[1] += 0.4  # far: from rest to rest this takes several frames
    for _ in range(5):
        *_, info = env.step(target)
        times.append(info["time"])
    np.testing.assert_allclose(np.diff(times), 0.06, atol=1e-9)


def test_the_experts_actions_ring_the_bell() -> None:
    task = load_task("click_bell")
    done = attempt(EpisodeSpec("click_bell", "clean").at(3), task, default_pack())
    assert done.recording is not None
    env = gymnasium.make(BELL)
    seen, info = env.reset(seed=3)
    assert (info["seed"], info["attempts"]) == (3, 1)
    assert (info["success"], info["reason"]) == (False, "running")
    first = done.recording.rows[0]
    np.testing.assert_allclose(seen["agent_pos"], first.arms, atol=1e-6)
    np.testing.assert_allclose(seen["objects"]["bell"], first.objects["bell"], atol=1e-6)
    np.testing.assert_allclose(seen["endposes"]["left"], first.ee[0], atol=1e-6)
    rewards = []
    for action in actions_of(done.recording):
        seen, reward, terminated, truncated, info = env.step(action.astype(np.float32))
        rewards.append(reward)
        if terminated:
            break
    assert terminated and not truncated and sum(rewards) == 1.0
    assert (info["success"], info["reason"]) == (True, "")


@pytest.mark.parametrize(
    ("robot", "numbers"), [("franka-panda", 16), ("piper,franka-panda,0.7", 15)]
)
def test_spaces_are_as_long_as_the_robot_has_numbers(robot: str, numbers: int) -> None:
    env = TaskEnv("click_bell", embodiment=robot)
    assert env.action_space.shape == (numbers,)
    seen, _ = env.reset(seed=0)
    assert env.observation_space.contains(seen)
    assert seen["measured"].shape == (numbers,)
    seen, *_ = env.step(seen["agent_pos"])
    assert env.observation_space.contains(seen)
    with pytest.raises(BadValue, match=f"it is {numbers} finite numbers: left arm"):
        env.step(np.zeros(14, np.float32))


def test_the_limit_truncates(monkeypatch: pytest.MonkeyPatch) -> None:
    env = TaskEnv("click_bell")
    seen, _ = env.reset(seed=0)
    assert env._episode is not None
    monkeypatch.setattr(env._episode, "step_limit", 3)
    ends = [env.step(seen["agent_pos"])[2:4] for _ in range(3)]
    assert ends == [(False, False), (False, False), (False, True)]
    with pytest.raises(gymnasium.error.ResetNeeded):
        TaskEnv("click_bell").step(seen["agent_pos"])


def test_physics_is_told_and_shown_only_on_request() -> None:
    held = {"friction": 0.2, "center_of_mass": np.array([0.001, 0.0, 0.0])}
    plain, shown = TaskEnv("click_bell"), TaskEnv("click_bell", show_physics=True)
    seen, info = plain.reset(seed=5, options={"protocol": "phys_random", "physics": held})
    assert "physics" not in seen
    assert info["protocol"] == "phys_random"
    assert info["physics"]["friction"] == 0.2
    assert info["physics"]["center_of_mass"] == (0.001, 0.0, 0.0)
    assert info["physics"]["object_mass"] != 1.0
    seen, info = shown.reset(seed=5)
    assert set(seen["physics"]) == set(attributes())
    assert info["physics"]["friction"] == seen["physics"]["friction"].item() == 0.5
    assert seen["physics"]["object_mass"].item() == 1.0
    assert seen["physics"]["center_of_mass"].shape == (3,)


def test_what_a_prop_has_of_its_own_is_shown_too() -> None:
    env = TaskEnv("heavy_below", show_physics=True)
    seen, info = env.reset(seed=2)
    assert isinstance(env.observation_space, spaces.Dict)
    assert set(env.observation_space["physics"]) == set(seen["physics"])  # type: ignore[call-overload]
    for key in ("object_mass@first", "object_mass@second"):
        assert seen["physics"][key].item() == pytest.approx(info["physics"][key])
    other = {"physics": {"friction@first": 0.7}}
    seen, info = env.reset(seed=2, options=other)
    assert "friction@first" in info["physics"], "the space was fixed before, so only info has it"
    assert env.observation_space.contains(seen)


@pytest.mark.parametrize("task", ["open_laptop", "put_object_cabinet", "open_microwave"])
def test_damping_that_is_the_assets_own_is_shown_as_the_simulator_has_it(task: str) -> None:
    """It was half of that: the mean of damping and dry friction."""
    env = TaskEnv(task, show_physics=True)
    seen, _ = env.reset(seed=0)
    assert env._episode is not None
    dampings = [joint.damping for joint in env._episode.instance.world.joints]
    assert seen["physics"]["object_joint_damping"].item() == pytest.approx(np.mean(dampings))


def test_conditions_of_make_last_and_those_of_reset_do_not() -> None:
    """A vector environment resets by itself, without options: nobody could say them again."""
    held = {"friction": 0.2}
    env = gymnasium.make(BELL, protocol="phys_random", physics=held, split="seen")
    told = [env.reset(seed=3)[1], env.reset()[1]]
    told.append(env.reset(seed=3, options={"protocol": "clean", "lerobot_new_rollout": True})[1])
    told.append(env.reset(seed=3)[1])
    said = [one["protocol"] for one in told]
    assert said == ["phys_random", "phys_random", "clean", "phys_random"]
    assert {one["physics"]["friction"] for one in told} == {0.2}
    assert told[0]["physics"] == told[3]["physics"] != told[1]["physics"]
    assert told[0]["instruction"] != TaskEnv("click_bell").reset(seed=3)[1]["instruction"]
    many = SyncVectorEnv([lambda: TaskEnv("click_bell", "phys_random", physics=held)])
    many.reset(seed=3)
    one = many.envs[0]
    assert isinstance(one, TaskEnv) and one._episode is not None
    one._episode.step_limit = 1
    still = np.stack([one.reset(seed=3)[0]["agent_pos"]])
    one._episode.step_limit = 1
    assert many.step(still)[3].all()
    info = many.step(still)[4]
    assert info["protocol"][0] == "phys_random"
    assert info["physics"]["friction"][0] == 0.2


def test_a_vector_environment_rounds_no_physics() -> None:
    """Gymnasium's arrays have the type of the first episode's value."""
    frictions = (1, 0.5, 0.2)
    many = SyncVectorEnv(
        [lambda held=held: TaskEnv("click_bell", physics={"friction": held}) for held in frictions]
    )
    assert tuple(many.reset(seed=3)[1]["physics"]["friction"]) == frictions


def test_resets_without_a_seed_differ_and_repeat() -> None:
    runs = []
    for _ in range(2):
        env = TaskEnv("click_bell")
        env.reset(seed=11)
        runs.append([env.reset()[1]["seed"] for _ in range(2)])
    assert runs[0] == runs[1]
    assert len(set(runs[0])) == 2


def test_a_world_that_does_not_come_to_rest_is_skipped(monkeypatch: pytest.MonkeyPatch) -> None:
    def restless(recipe: Recipe, *rest: object) -> PolicyEpisode:
        if recipe.seed == 4:
            raise Infeasible("unsettled", "the bell still moved after 3 s")
        return begin(recipe, *rest)

    monkeypatch.setattr(env_module, "begin", restless)
    env = TaskEnv("click_bell")
    assert env.reset(seed=4)[1]["seed"] == 5
    # Another seed would be no certified instance.
    monkeypatch.setattr(env_module, "certified_seed", lambda *_: 4)
    with pytest.raises(Infeasible, match="unsettled"):
        env.reset(options={"index": np.int64(0)})


@pytest.mark.parametrize(
    ("options", "problem"),
    [
        ({"protocoll": "clean"}, "did you mean 'protocol'"),
        ({"physics": {"frictoin": 0.2}}, "friction"),
        ({"physics": {"friction": -1.0}}, "friction"),
        ({"index": "first"}, "index"),
        ({"index": 10**6}, "certified"),
        ({"index": np.int64(10**6)}, "certified"),
        ({"split": "sen"}, "unseen"),
    ],
)
def test_what_is_wrong_with_an_option_is_said(options: dict, problem: str) -> None:
    with pytest.raises((UnknownName, BadValue), match=problem):
        TaskEnv("click_bell").reset(options=options)


@pytest.mark.parametrize(
    ("of", "problem"),
    [
        ({"protocol": "phys_randm"}, "phys_random"),
        ({"obs": "pixel"}, "pixels"),
        ({"control": "tracked"}, r"control.*tracking"),
        ({"physics": {"frictoin": 0.2}}, "friction"),
        ({"split": "sen"}, "unseen"),
        ({"senses": ("states",)}, "observed sense"),
        ({"render_mode": "human"}, "rgb_array"),
    ],
)
def test_what_is_wrong_with_an_argument_is_said(of: dict, problem: str) -> None:
    with pytest.raises(UnknownName, match=problem):
        TaskEnv("click_bell", **of)


def make() -> TaskEnv:
    return TaskEnv("click_bell", "phys_random")


@pytest.mark.slow
def test_gymnasiums_own_vector_environment() -> None:
    """The same worlds in processes of their own, step by step."""
    alone = [make(), make()]
    first = [env.reset(seed=seed)[0] for env, seed in zip(alone, (7, 8), strict=True)]
    many = AsyncVectorEnv([make, make], context="spawn")
    try:
        seen, info = many.reset(seed=[7, 8])
        assert info["physics"]["friction"].tolist() == [
            env._episode.instance.physics["friction"] for env in alone if env._episode
        ]
        action = np.stack([one["agent_pos"] for one in first]) + np.float32(0.1)
        action = np.clip(action, many.action_space.low, many.action_space.high)
        seen, reward, _, _, _ = many.step(action)
        own = [env.step(action[i])[0] for i, env in enumerate(alone)]
        for i in range(2):
            for key in ("measured", "velocities", "efforts"):
                np.testing.assert_array_equal(seen[key][i], own[i][key])
            np.testing.assert_array_equal(seen["objects"]["bell"][i], own[i]["objects"]["bell"])
        assert reward.tolist() == [0.0, 0.0]
    finally:
        many.close()


@pytest.mark.render
def test_senses_are_observed_on_request() -> None:
    env = TaskEnv("click_bell", senses=("depth", "segmentation", "pointcloud"))
    seen, info = env.reset(seed=0)
    assert env.observation_space.contains(seen)
    assert 0.3 < seen["depth"]["head"].min() < seen["depth"]["head"].max() < 2
    shown = {info["bodies"][i] for i in np.unique(seen["segmentation"]["head"])}
    assert {"table", "bell"} <= shown
    assert seen["pointcloud"].shape == (1024, 6)


class Nested(gymnasium.Env):
    """Any environment with nested observations."""

    observation_space = spaces.Dict(
        {
            "pixels": spaces.Dict({"head": spaces.Box(0, 255, (4, 5, 3), np.uint8)}),
            "agent_pos": spaces.Box(-1, 1, (3,), np.float32),
        }
    )
    action_space = spaces.Discrete(2)

    def reset(self, *, seed=None, options=None):
        super().reset(seed=seed)
        self.observation_space.seed(seed)
        return self.observation_space.sample(), {}

    def step(self, action):
        return self.observation_space.sample(), 0.0, False, False, {}


def test_one_level_remains() -> None:
    env = FlatObservation(Nested())
    assert isinstance(env.observation_space, spaces.Dict)
    assert set(env.observation_space.spaces) == {"pixels_head", "agent_pos"}
    assert not any(isinstance(part, spaces.Dict) for part in env.observation_space.spaces.values())
    observation, _ = env.reset(seed=1)
    assert env.observation_space.contains(observation)
    assert observation["pixels_head"].dtype == np.uint8
    check_env(env, skip_render_check=True)


def test_what_is_not_nested_is_refused() -> None:
    class Plain(Nested):
        observation_space = spaces.Box(-1, 1, (3,), np.float32)

    class Twice(Nested):
        observation_space = spaces.Dict(
            {"a_b": spaces.Discrete(2), "a": spaces.Dict({"b": spaces.Discrete(2)})}
        )

    with pytest.raises(TypeError, match="not a mapping"):
        FlatObservation(Plain())
    with pytest.raises(ValueError, match="one name"):
        FlatObservation(Twice())


def test_a_flat_task_passes_gymnasiums_own_check() -> None:
    env = FlatObservation(TaskEnv("open_laptop", "phys_random", show_physics=True))
    with warnings.catch_warnings():
        warnings.filterwarnings("ignore")
        check_env(env, skip_render_check=True)
    observation, _ = env.reset(seed=0)
    assert {"endposes_left", "joints_laptop", "physics_friction"} <= set(observation)
