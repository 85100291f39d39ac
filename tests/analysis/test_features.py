"""Features: statistics of each stage, by the role that an arm has in an episode."""

import numpy as np
import pytest

from rtphys.analysis.features import (
    ArmRows,
    arm_rows,
    features_of,
    signals,
    tool_wrench,
    without_sides,
)
from rtphys.analysis.scoring import Sample, group_of
from rtphys.assets.embodiment import Embodiment
from rtphys.assets.pack import default_pack
from rtphys.core.poses import Array
from rtphys.senses.touch import Touch, TouchSense
from rtphys.sim.recorder import Recording, Row

STAGES = ("start", "right grasp block", "right lift", "right grasp block", "hold")


def recording(embodiment: Embodiment, moved: str = "right", objects: float = 0.0) -> Recording:
    """Twenty rows, four a stage, in which the joints of one side (or `both`) turn steadily.

    Args:
        objects: [m] by which all objects stand elsewhere, which nothing may sense.
    """
    limbs = {limb.side: limb for limb in embodiment.limbs}
    names = tuple(
        name
        for side in ("left", "right")
        for name in (*limbs[side].joints, *limbs[side].finger_joints)
    )
    layout = embodiment.action_layout
    found = Recording(names, layout, stages=list(STAGES))
    for k in range(20):
        commands = np.zeros(layout.size)
        for side, place in zip(("left", "right"), layout.arms, strict=True):
            commands[place] = limbs[side].bent + (0.01 * k if moved in (side, "both") else 0.0)
        commands[list(layout.grippers)] = 0.5
        qpos = np.zeros(len(names))
        for side, place in zip(("left", "right"), layout.arms, strict=True):
            arm = [names.index(name) for name in limbs[side].joints]
            qpos[arm] = commands[place] - 0.002
            fingers = [names.index(name) for name in limbs[side].finger_joints]
            qpos[fingers] = 0.5 * limbs[side].hand.finger_open
        found.rows.append(
            Row(
                time=0.06 * k,
                stage=k // 4,
                arms=commands,
                ee=np.zeros((2, 7)),
                qpos=qpos,
                qvel=np.zeros(len(names)),
                effort=np.full(len(names), 0.1 * k),
                objects={"block": np.full(7, objects)},
                touched={"block": (False, k >= 8), "plate": (False, False)},
                packed=b"",
            )
        )
    return found


@pytest.fixture(scope="session")
def embodiment() -> Embodiment:
    return default_pack().embodiment()


@pytest.mark.parametrize(
    ("stage", "name"),
    [
        ("left grasp pot + right grasp pot", "grasp pot"),
        ("left place can + right lift", "place can + lift"),
        ("recover left grasp can", "recover grasp can"),
        ("right", "right"),
        ("start", "start"),
    ],
)
def test_a_stage_has_one_name_whatever_the_arm(stage: str, name: str) -> None:
    assert without_sides(stage) == name


def test_statistics_are_those_of_the_stage_alone(embodiment: Embodiment) -> None:
    found = Sample(0, features_of(recording(embodiment), embodiment)).columns
    name = "lift/hand/effort/effort_1"  # 0.1 k in rows 8 to 11
    assert found[f"{name}/mean"] == pytest.approx(0.95)
    assert found[f"{name}/least"] == pytest.approx(0.8)
    assert found[f"{name}/most"] == found[f"{name}/final"] == pytest.approx(1.1)
    assert found[f"{name}/change"] == pytest.approx(0.3)
    assert found["lift/duration"] == pytest.approx(0.18)
    assert found["whole/duration"] == pytest.approx(19 * 0.06)
    assert found["grasp block 2/hand/touch/touch/mean"] == 1
    assert found["grasp block/hand/touch/touch/mean"] == 0


def test_the_arm_that_moves_is_the_hand_and_an_idle_one_has_no_features(
    embodiment: Embodiment,
) -> None:
    for side, number in (("left", 0), ("right", 1)):
        found = features_of(recording(embodiment, moved=side), embodiment)
        assert found["whole/side"] == number
        assert not [name for name in found if "/other/" in name]
    both = features_of(recording(embodiment, moved="both"), embodiment)
    assert both["whole/side"] == 0
    assert [name for name in both if "/other/" in name]


def test_every_feature_belongs_to_a_group() -> None:
    assert group_of("lift/hand/effort/force_z/mean") == "effort"
    assert group_of("lift/duration") == group_of("whole/side") == "timing"


FORCE = np.array([1.5, -2.0, 4.0])  # [N] on the tool


@pytest.fixture(scope="module")
def arm(embodiment: Embodiment) -> ArmRows:
    return arm_rows(recording(embodiment), embodiment)[1]


def tool(arm: ArmRows, q: Array) -> Array:
    return (arm.kinematics.ee_matrix(q) @ (arm.tcp, 0, 0, 1))[:3]


def test_force_on_the_tool_comes_out_of_the_efforts_that_hold_it(arm: ArmRows) -> None:
    """By virtual work: effort of a joint is minus the force times the tool's way per radian."""
    q, step = arm.joints[0], 1e-6
    ways = [
        (tool(arm, q + step * e) - tool(arm, q - step * e)) / (2 * step) for e in np.eye(len(q))
    ]
    effort = -np.array(ways) @ FORCE
    wrench = tool_wrench(arm, q, effort)
    np.testing.assert_allclose(wrench[:3], FORCE, atol=1e-3)
    np.testing.assert_allclose(wrench[3:], 0, atol=1e-3)


def test_signals_follow_the_rows(arm: ArmRows) -> None:
    found = signals(arm)
    groups = {"commands", "joints", "tracking", "effort", "touch"}
    assert {name.partition("/")[0] for name in found} == groups
    assert all(values.shape == (20,) for values in found.values())
    np.testing.assert_allclose(found["tracking/lag_3"], 0.002)
    np.testing.assert_allclose(found["tracking/lag_opening"], 0, atol=1e-12)
    np.testing.assert_allclose(found["joints/tool_z"], [tool(arm, q)[2] for q in arm.joints])
    assert found["touch/touch"].tolist() == [0] * 8 + [1] * 12


def test_no_object_is_sensed(embodiment: Embodiment) -> None:
    here, there = (
        signals(arm_rows(recording(embodiment, objects=away), embodiment)[1]) for away in (0.0, 0.3)
    )
    for name, values in here.items():
        np.testing.assert_array_equal(values, there[name])


TOUCHED = [field.name for field in TouchSense.fields]


def felt(**values: float) -> Touch:
    """Twenty frames of four fingers; only the right hand's feel these values."""
    arrays = {key: np.zeros((20, 4), np.float32) for key in TOUCHED}
    arrays |= {"force": np.zeros((20, 4, 3), np.float32), "pressed": np.zeros((20, 4, 0))}
    for key, value in values.items():
        arrays[key][:, 2:] = value
    return Touch(("a", "b", "c", "d"), (), **arrays)  # type: ignore[arg-type]


def test_each_hand_feels_its_own_pads(embodiment: Embodiment) -> None:
    touch = felt(normal=4.0, tangential=1.0, slip=0.01)
    left, right = (signals(a) for a in arm_rows(recording(embodiment), embodiment, touch))
    np.testing.assert_allclose(right["touch/normal"], 4.0)
    np.testing.assert_allclose(right["touch/slipping_ratio"], 0.25)
    assert not any(left[name].any() for name in left if name.startswith("touch/"))


def test_pads_that_hold_tell_no_friction(embodiment: Embodiment) -> None:
    touch = felt(normal=4.0, tangential=1.0, slip=0.0)
    held = signals(arm_rows(recording(embodiment), embodiment, touch)[1])
    np.testing.assert_allclose(held["touch/ratio"], 0.25)
    np.testing.assert_allclose(held["touch/slipping_ratio"], 0)


def test_the_margin_which_knows_the_friction_is_no_signal(embodiment: Embodiment) -> None:
    one, other = (
        signals(arm_rows(recording(embodiment), embodiment, felt(normal=1.0, margin=margin))[1])
        for margin in (0.2, 0.9)
    )
    for name, values in one.items():
        np.testing.assert_array_equal(values, other[name])
