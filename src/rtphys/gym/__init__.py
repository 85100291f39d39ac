"""The tasks as Gymnasium environments.

import rtphys.gym, gymnasium as gym  # this order: see `rtphys.core.pinned`
env = gym.make("rtphys/click_bell-v0", protocol="phys_random", physics={"friction": 0.2})

Importing this module registers them; `gym.make("rtphys.gym:rtphys/click_bell-v0")` imports it.
"""

import rtphys.core.pinned  # noqa: F401  # isort: skip  (before numpy)

from collections.abc import Iterator, Mapping
from contextlib import suppress
from typing import Any, cast

import gymnasium
from gymnasium import spaces
from numpy.typing import NDArray

from rtphys.core import library

__all__ = ["FlatObservation", "env_id", "register_all"]

Flat = dict[str, NDArray[Any]]


def env_id(task: str) -> str:
    """Gymnasium's name of a task: `rtphys/<task>-v0`."""
    return f"rtphys/{task}-v0"


def register_all() -> None:
    """Register every task of the libraries, without loading SAPIEN or a task file.

    One whose name Gymnasium allows in no id is left out.
    """
    for task in library.names("tasks", None):
        if env_id(task) not in gymnasium.registry:
            # No max_episode_steps: the environment truncates by the limit in the task file.
            entry = "rtphys.gym.env:TaskEnv"
            with suppress(gymnasium.error.Error):  # no id may hold a space; other tasks have one
                gymnasium.register(env_id(task), entry_point=entry, kwargs={"task": task})


class FlatObservation(
    gymnasium.ObservationWrapper[Flat, NDArray[Any], dict[str, Any]],
    gymnasium.utils.RecordConstructorArgs,
):
    """One level of arrays: `pixels/head` becomes `pixels_head`, `objects/bell` `objects_bell`.

    Stable-Baselines3's `MultiInputPolicy` takes these; it refuses a mapping inside a mapping.

    Args:
        env: an environment whose observations are mappings, nested to any depth.

    Raises:
        TypeError: they are not.
        ValueError: two entries get one name.
    """

    def __init__(self, env: gymnasium.Env[dict[str, Any], NDArray[Any]]) -> None:
        gymnasium.utils.RecordConstructorArgs.__init__(self)
        gymnasium.ObservationWrapper.__init__(self, env)
        if not isinstance(env.observation_space, spaces.Dict):
            raise TypeError(f"observations are {env.observation_space}, not a mapping")
        entries = list(_entries(env.observation_space.spaces))
        if len(names := dict(entries)) < len(entries):
            raise ValueError("two entries of the observation get one name")
        self.observation_space = cast(spaces.Space[Flat], spaces.Dict(names))

    def observation(self, observation: Mapping[str, Any]) -> Flat:
        """The same arrays under their flat names."""
        return dict(_entries(observation))


def _entries(nested: Mapping[str, Any], before: str = "") -> Iterator[tuple[str, Any]]:
    for key, value in nested.items():
        inner = value.spaces if isinstance(value, spaces.Dict) else value
        if isinstance(inner, Mapping):
            yield from _entries(inner, f"{before}{key}_")
        else:
            yield f"{before}{key}", value


register_all()  # since 1.0, Gymnasium loads no entry points
