"""Attributes of the example library: each obeys its law, alone and with all others varied."""

import shutil
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest

from rtphys.assets.pack import default_pack
from rtphys.laws.lab import HALF, Lab, block, record, slope
from rtphys.laws.law import NoLawTest, law_test, law_tests_of, run_trials, trials_of
from rtphys.physics import attributes, disagreements, load_domain
from rtphys.physics.handles import GRAVITY
from rtphys.sim.engine import TIME_STEP

LIBRARY = Path(__file__).parents[2] / "examples" / "own_attributes"
OTHERS = [{}, {"object_mass": 2.0, "object_scale": 0.9, "arm_joint_damping": 2.0}]


@pytest.fixture
def lab(monkeypatch: pytest.MonkeyPatch) -> Iterator[Lab]:
    monkeypatch.setenv("RTPHYS_LIBRARY", str(LIBRARY))
    yield Lab(default_pack())


def test_a_root_domain_holds_what_it_does_not_name(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("RTPHYS_LIBRARY", str(LIBRARY))
    physics = load_domain("thick_air").sample(3)
    assert set(physics.varied) == {"linear_drag", "gravity", "actuator_latency", "friction"}
    assert physics["object_mass"] == attributes()["object_mass"].nominal


@pytest.mark.sim
@pytest.mark.parametrize("key", ["actuator_latency", "gravity", "linear_drag"])
def test_its_own_proof_holds_and_fails_without_the_effect(
    lab: Lab, monkeypatch: pytest.MonkeyPatch, key: str
) -> None:
    law = law_test(key)
    values = {key: law.settings[-1]}
    assert not disagreements(lab.world([block(HALF, (0, 0, 2))], values), lab.physics(values))
    trials = list(trials_of(lab, law))
    assert len(trials) == 2 * len(law.settings) and all(trial.passed for trial in trials)
    monkeypatch.setattr(attributes()[key], "apply", lambda target, value: None)
    monkeypatch.setattr(attributes()[key], "read", lambda world: {})
    assert not all(trial.passed for trial in run_trials(lab, law, law.settings[-1], {}))


def test_an_attribute_without_a_proof_is_said_to_have_none(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    shutil.copytree(LIBRARY, tmp_path / "mine", ignore=shutil.ignore_patterns("gravity.py"))
    shutil.copy(LIBRARY / "attributes" / "gravity.py", tmp_path / "mine" / "attributes")
    monkeypatch.setenv("RTPHYS_LIBRARY", str(tmp_path / "mine"))
    with pytest.raises(NoLawTest, match=r"gravity has no experiment: laws/gravity\.py"):
        law_test("gravity")
    laws, without = law_tests_of(None)
    assert len(laws) == 15 and [text.split()[1] for text in without] == ["gravity"]


@pytest.mark.sim
def test_applied_twice_a_planet_is_the_same(lab: Lab) -> None:
    world = lab.world([block(HALF, (0, 0, 2))], {"gravity": 1.62})
    attributes()["gravity"].apply(world, GRAVITY)
    (body,) = world.bodies
    t, v = record(world, 50, lambda: body.component.linear_velocity[2])
    assert slope(t, v) == pytest.approx(-GRAVITY, rel=1e-3)


@pytest.mark.sim
@pytest.mark.parametrize("others", OTHERS)
def test_a_late_arm_does_the_same_later(lab: Lab, others: dict[str, float]) -> None:
    def response(latency: float) -> np.ndarray:
        world = lab.world([], {**others, "actuator_latency": latency})
        arm = world.robot.arms[0]
        home = list(arm.target)
        record(world, 100, lambda: 0.0)  # servos rest, as at an episode's beginning
        sent = [*home[:2], home[2] + 0.2, *home[3:]]
        arm.drive(sent, [0.0] * len(home))
        _, q = record(world, 60, arm.measured)
        assert list(arm.target) == sent  # what was sent, not what has arrived
        return q

    steps = round(40e-3 / TIME_STEP)
    prompt, late = response(0.0), response(40.0)
    assert np.ptp(prompt[:, 2]) > 0.05
    np.testing.assert_allclose(late[steps:], prompt[:-steps], atol=1e-5)
    np.testing.assert_allclose(late[:steps], np.tile(late[0], (steps, 1)), atol=1e-5)
