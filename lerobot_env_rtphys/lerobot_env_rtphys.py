"""LeRobot's `--env.type=rtphys`: the tasks of rtphys, by default on its certified instances."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import partial
from typing import Any

import gymnasium
from gymnasium import spaces
from lerobot.configs import FeatureType, PolicyFeature
from lerobot.envs import EnvConfig
from lerobot.envs.utils import _LazyAsyncVectorEnv, freeze_after_episode_end
from lerobot.utils.constants import ACTION, OBS_IMAGES, OBS_STATE

from rtphys.assets.embodiment import DEFAULT
from rtphys.core import library
from rtphys.core.errors import UnknownName
from rtphys.data.episode import CAMERA_NAMES
from rtphys.gym.env import TaskEnv
from rtphys.spec.recording import CAMERAS, USUAL
from rtphys.task.spec import load_task

NAMES = {  # of our cameras, as in `rtphys export lerobot --camera-names`
    style: {name: naming[CAMERAS[name]] for name in USUAL} for style, naming in CAMERA_NAMES.items()
}
LISTED = 1000  # seeds of LeRobot that count certified instances from 0; a list has 100


class LeRobotTask(gymnasium.Wrapper):
    """A task as LeRobot's rollout reads it.

    Args:
        task: its name.
        cameras: name of each of our cameras.
        certified: seed n of LeRobot, modulo `LISTED`, is the nth certified instance.
        options: further arguments of `TaskEnv`.
    """

    def __init__(
        self, task: str, cameras: Mapping[str, str], certified: bool, options: Mapping[str, Any]
    ) -> None:
        super().__init__(TaskEnv(task, obs="pixels", render_mode="rgb_array", **options))
        self._cameras, self._certified = cameras, certified
        self.task, self.task_description = task, ""
        self._max_episode_steps = load_task(task).step_limit
        parts = dict(self.env.observation_space.spaces)
        parts["pixels"] = spaces.Dict({cameras[key]: s for key, s in parts["pixels"].items()})
        self.observation_space = spaces.Dict(parts)

    def reset(self, *, seed: int | None = None, options: Mapping[str, Any] | None = None) -> Any:
        if seed is not None and self._certified:
            seed, options = None, {**(options or {}), "index": seed % LISTED}
        seen, info = self.env.reset(seed=seed, options=options)
        self.task_description = info["instruction"]
        return self._shown(seen), {**info, "is_success": info["success"]}

    def step(self, action: Any) -> Any:
        seen, reward, terminated, truncated, info = self.env.step(action)
        info = {**info, "is_success": info["success"]}
        return self._shown(seen), reward, terminated, truncated, info

    def _shown(self, seen: Mapping[str, Any]) -> dict[str, Any]:
        self._picture = seen["pixels"]["head"]
        named = {self._cameras[key]: picture for key, picture in seen["pixels"].items()}
        return {**seen, "pixels": named}

    def render(self) -> Any:
        """The head camera's picture, which needs not be drawn again."""
        return self._picture


@EnvConfig.register_subclass("rtphys")
@dataclass
class RtphysEnv(EnvConfig):
    """What `--env.KEY=VALUE` sets; tasks and protocols may be several, with commas."""

    task: str | None = "click_bell"  # names and patterns, as in `rtphys collect --task`
    fps: int = 17
    protocol: str = "clean"
    split: str = "unseen"
    physics: dict[str, float] = field(default_factory=dict)  # attributes held at a value
    embodiment: str = DEFAULT
    control: str = "official"
    camera_names: str = "aloha"  # or "robotwin"
    certified: bool = True  # seeds count certified instances; false: they are seeds of episodes

    def __post_init__(self) -> None:
        if self.camera_names not in NAMES:
            raise UnknownName("camera naming", self.camera_names, NAMES)
        self._tasks = library.matching("tasks", (self.task or "").split(","))
        first = self._maker(self._tasks[0], self.protocol.split(",")[0])()
        size, cameras = first.action_space.shape, first.observation_space["pixels"].spaces
        self.features[ACTION] = PolicyFeature(FeatureType.ACTION, size)
        self.features["agent_pos"] = PolicyFeature(FeatureType.STATE, size)
        self.features_map |= {ACTION: ACTION, "agent_pos": OBS_STATE}
        for name, space in cameras.items():
            key = f"{OBS_IMAGES}.{name}"
            self.features[key] = PolicyFeature(FeatureType.VISUAL, space.shape)
            self.features_map[key] = key

    def _maker(self, task: str, protocol: str) -> partial[LeRobotTask]:
        of = ("split", "physics", "embodiment", "control")
        options = {"protocol": protocol, **{key: getattr(self, key) for key in of}}
        return partial(LeRobotTask, task, NAMES[self.camera_names], self.certified, options)

    @property
    def gym_kwargs(self) -> dict[str, Any]:
        return {}  # `create_envs` needs none

    def create_envs(
        self, n_envs: int, use_async_envs: bool = False
    ) -> dict[str, dict[int, gymnasium.vector.VectorEnv]]:
        """`{"<task>_<protocol>": {0: n_envs environments}}`; ended episodes wait for the rest."""
        made: dict[str, dict[int, gymnasium.vector.VectorEnv]] = {}
        for protocol in self.protocol.split(","):
            for task in self._tasks:
                makers = [self._maker(task, protocol)] * n_envs
                if use_async_envs and n_envs > 1:  # processes begin with the task's first episode
                    vector = _LazyAsyncVectorEnv(makers)
                else:
                    frozen = [freeze_after_episode_end(one) for one in makers]
                    vector = gymnasium.vector.SyncVectorEnv(frozen)
                made[f"{task}_{protocol}"] = {0: vector}
        return made
