"""Policies that learn nothing: reference values of a task, from no motion to a recording."""

from pathlib import Path

import numpy as np

from rtphys.assets.embodiment import DEFAULT, Embodiment
from rtphys.core.errors import BadFile, BadValue
from rtphys.core.poses import Array
from rtphys.core.seeds import stream
from rtphys.data.dataset import Dataset
from rtphys.data.dataset import Episode as Stored
from rtphys.episode import Observation, PolicyEpisode
from rtphys.policies.policy import PolicyGone, PolicySetup, Stepwise

# Of `random`: standard deviations of the step from one action to the next. An arm completes a step
# of 0.013 rad within one frame; with the drift, 400 actions move a joint by about 0.6 rad.
ARM_STEP = 0.007  # [rad]
GRIP_STEP = 0.025  # of the opening, 0..1
DRIFT = 0.9  # correlation of successive steps; without it the robot only shakes on the spot
# Of `jitter`: standard deviation of each number: [rad] of joints, and of the opening, 0..1.
SPREAD = 0.1


class Idle(Stepwise):
    """`idle` repeats the current command: a task that it solves needs no action."""

    needs_images = False

    def act(self, observation: Observation) -> Array:
        return observation.vector


def limits(robot: Embodiment) -> Array:
    """(2, N) lowest and highest numbers of an action: joints [rad], openings 0 closed .. 1 open."""
    return np.concatenate([np.vstack([limb.limits, [0.0, 1.0]]) for limb in robot.limbs]).T


class RandomWalk(Stepwise):
    """`random` walks at random from the home posture: a task that it solves is too easy.

    Each step keeps most of the last one, and turns back at the limits.
    """

    needs_images = False

    def reset(self, episode: PolicyEpisode) -> None:
        self._rng = stream(episode.seed, "policy", "random")
        robot = episode.rollout.world.robot.embodiment
        self._low, self._high = limits(robot)
        self._scale = np.full(len(self._low), ARM_STEP)
        self._scale[list(robot.action_layout.grippers)] = GRIP_STEP
        self._step = self._rng.normal(size=len(self._scale)) * self._scale

    def act(self, observation: Observation) -> Array:
        fresh = self._rng.normal(size=len(self._scale)) * self._scale
        self._step = DRIFT * self._step + np.sqrt(1 - DRIFT**2) * fresh
        target = observation.vector + self._step
        low, high = target < self._low, target > self._high
        target = np.where(low, 2 * self._low - target, target)
        target = np.where(high, 2 * self._high - target, target)
        self._step = np.where(low | high, -self._step, self._step)
        return np.clip(target, self._low, self._high)


class Jitter(Stepwise):
    """`jitter` commands the present posture plus independent normal noise, grippers too.

    Its steps are large and independent; those of `random` are small and correlated.
    """

    needs_images = False

    def reset(self, episode: PolicyEpisode) -> None:
        self._rng = stream(episode.seed, "policy", "jitter")
        self._low, self._high = limits(episode.rollout.world.robot.embodiment)

    def act(self, observation: Observation) -> Array:
        target = observation.vector + self._rng.normal(scale=SPREAD, size=len(observation.vector))
        return np.clip(target, self._low, self._high)


class Replay:
    """`replay:DATASET` replays the recorded actions of the same task and seed, open loop.

    If the dataset has a single configuration, it may be another one: `replay:CLEAN` under
    `phys_random` measures how far actions recorded under clean physics succeed under random
    physics.

    Raises `BadFile`: the folder holds no dataset; `UnknownName`, `BadValue`: the dataset lacks this
    task, or has several configurations without this, such as those of a sweep.
    """

    needs_images = False

    def __init__(self, folder: Path, task: str, protocol: str, embodiment: str = DEFAULT) -> None:
        data = Dataset(folder).where(task=task, embodiment=embodiment)
        if protocol in data.protocols:
            data = data.where(protocol=protocol)  # a twin's configuration has another name
        if protocol in data.configs:
            data = data.where(config=protocol)
        elif len(data.configs) > 1:
            allowed = f"several configurations and no {protocol} in it; `rtphys subset` copies one"
            raise BadValue("policy", f"replay:{folder}", allowed)
        self._folder = folder
        self.stored: dict[int, Stored] = {episode.seed: episode for episode in data}

    def play(self, episode: PolicyEpisode) -> None:
        if episode.seed not in self.stored:
            problem = f"{self._folder} holds no episode of {episode.task}, seed {episode.seed}"
            cure = "collect that seed, or evaluate on this dataset's own instances"
            raise PolicyGone("replay", f"{problem}; {cure}")
        for action in self.stored[episode.seed].action:
            if episode.over:
                return
            episode.act(action)

    def close(self) -> None: ...


def open_replay(argument: str, setup: PolicySetup) -> Replay:
    """Opener of `replay:DATASET`."""
    if not argument:
        raise BadValue("policy", "replay:", "name a dataset's folder: replay:DATASET")
    folder = Path(argument)
    if not folder.exists():
        raise BadFile(folder, "no such dataset")
    return Replay(folder, setup.task, setup.protocol, setup.embodiment)
