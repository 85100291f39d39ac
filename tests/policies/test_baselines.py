"""The policy that trembles: what it adds, what it is keyed by, and that it fails."""

from pathlib import Path
from types import SimpleNamespace
from typing import cast

import numpy as np
import pytest
import synthetic
from collected import collect

from rtphys.assets.pack import default_pack
from rtphys.core.errors import BadValue
from rtphys.episode import Observation, PolicyEpisode
from rtphys.policies import PolicySetup, open_policy
from rtphys.policies.baselines import SPREAD, Jitter, Replay
from rtphys.spec.episode import EpisodeSpec
from rtphys.studies.check import solves
from rtphys.task.spec import load_task

MIDDLE = np.full(14, 0.5)  # of limits -10 .. 11 and openings 0 .. 1


def actions(seed: int, command: np.ndarray, count: int) -> np.ndarray:
    limb = SimpleNamespace(limits=np.array([[-10.0, 11.0]] * 6))
    robot = SimpleNamespace(embodiment=SimpleNamespace(limbs=(limb, limb)))
    world = SimpleNamespace(robot=robot)
    policy = Jitter()
    policy.reset(
        cast(PolicyEpisode, SimpleNamespace(seed=seed, rollout=SimpleNamespace(world=world)))
    )
    seen = cast(Observation, SimpleNamespace(vector=command))
    return np.array([policy.act(seen) for _ in range(count)])


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
