"""The policies that see nothing: what they add, what they are keyed by, and that they fail."""

from collections.abc import Sequence
from pathlib import Path
from types import SimpleNamespace
from typing import cast

import numpy as np
import pytest
import synthetic
from collected import collect

from rtphys.assets.action_layout import ActionLayout
from rtphys.assets.pack import default_pack
from rtphys.core.errors import BadValue
from rtphys.episode import Observation, PolicyEpisode
from rtphys.policies import PolicySetup, open_policy
from rtphys.policies.baselines import SPREAD, Jitter, RandomWalk, Replay
from rtphys.spec.episode import EpisodeSpec
from rtphys.studies.check import solves
from rtphys.task.spec import load_task

MIDDLE = np.full(14, 0.5)  # of limits -10 .. 11 and openings 0 .. 1


def opened(
    policy: Jitter | RandomWalk,
    seed: int,
    joints: Sequence[int] = (6, 6),
    limits: tuple[float, float] = (-10.0, 11.0),
) -> Jitter | RandomWalk:
    """The policy at the beginning of an episode of a robot with so many joints an arm."""
    limbs = [SimpleNamespace(limits=np.array([limits] * n)) for n in joints]
    robot = SimpleNamespace(limbs=limbs, action_layout=ActionLayout(*joints))
    world = SimpleNamespace(robot=SimpleNamespace(embodiment=robot))
    episode = SimpleNamespace(seed=seed, rollout=SimpleNamespace(world=world))
    policy.reset(cast(PolicyEpisode, episode))
    return policy


def acted(policy: Jitter | RandomWalk, command: np.ndarray) -> np.ndarray:
    return policy.act(cast(Observation, SimpleNamespace(vector=command)))


def actions(seed: int, command: np.ndarray, count: int) -> np.ndarray:
    policy = opened(Jitter(), seed)
    return np.array([acted(policy, command) for _ in range(count)])


def walk(seed: int, joints: Sequence[int]) -> np.ndarray:
    """Two hundred commands that follow each other."""
    policy, command = opened(RandomWalk(), seed, joints, (-0.1, 0.2)), np.zeros(sum(joints) + 2)
    return np.array([command := acted(policy, command) for _ in range(200)])


@pytest.mark.parametrize("joints", [(6, 6), (6, 7)])
def test_the_random_walk_stays_within_limits_and_is_keyed(joints: tuple[int, int]) -> None:
    walked, again, other = (walk(seed, joints) for seed in (1, 1, 2))
    hands = walked[:, [joints[0], -1]]
    arms = np.delete(walked, [joints[0], -1], axis=1)
    assert arms.min() >= -0.1 and arms.max() <= 0.2 < np.ptp(arms)
    assert 0 <= hands.min() <= hands.max() <= 1
    assert (walked == again).all() and (walked != other).any()


def test_every_number_trembles_about_the_present_command() -> None:
    steps = actions(3, MIDDLE, 4000) - MIDDLE
    np.testing.assert_allclose(steps.std(0), SPREAD, rtol=0.1)
    np.testing.assert_allclose(steps.mean(0), 0.0, atol=0.01)
    assert np.abs(np.corrcoef(steps.T) - np.eye(14)).max() < 0.1
    assert abs(np.corrcoef(steps[:-1, 0], steps[1:, 0])[0, 1]) < 0.1  # it keeps no direction


def test_it_stays_within_limits() -> None:
    shut = np.where(np.arange(14) % 7 == 6, 0.0, 11.0)
    commanded = actions(3, shut, 200)
    assert commanded[:, [6, 13]].min() == 0.0
    assert commanded[:, [6, 13]].max() <= 1.0
    assert commanded.max() == 11.0


def test_it_is_keyed_by_the_episode() -> None:
    assert (actions(1, MIDDLE, 5) == actions(1, MIDDLE, 5)).all()
    assert (actions(1, MIDDLE, 5) != actions(2, MIDDLE, 5)).all()


def swept(out: Path, *held: dict[str, float]) -> Path:
    for overrides in held:
        collect(out, 2, synthetic.header(overrides=overrides))
    return out


def test_actions_of_one_value_of_a_sweep_are_not_taken_for_those_of_another(
    tmp_path: Path,
) -> None:
    """Every value has the same seeds; the last one recorded was replayed."""
    several = swept(tmp_path / "several", {"friction": 0.2}, {"friction": 0.8})
    for protocol in ("phys_random", "clean"):
        with pytest.raises(BadValue, match="several configurations and no"):
            open_policy(f"replay:{several}", PolicySetup("click_bell", protocol))
    for held in ({}, {"friction": 0.2}), ({"friction": 0.2},):
        found = Replay(swept(tmp_path / str(len(held)), *held), "click_bell", "phys_random")
        (config,) = {one.config for one in found.stored.values()}
        assert config == ("phys_random" if {} in held else "phys_random.friction=0.2")


@pytest.mark.sim
@pytest.mark.slow
@pytest.mark.parametrize("name", ["click_bell", "press_stapler", "click_alarmclock"])
def test_trembling_presses_nothing(name: str) -> None:
    task, pack = load_task(name), default_pack()
    assert not any(
        solves(EpisodeSpec(name, "clean").at(seed), task, pack, "jitter") for seed in range(3)
    )
