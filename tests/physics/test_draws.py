"""Draws: independent streams, partial sampling, overrides, the camera's modes, redraws."""

import numpy as np
import pytest

from rtphys.core.errors import BadValue, Infeasible, UnknownName
from rtphys.physics import after, load_domain
from rtphys.physics.distribution import By, Fixed, SameAs, Uniform
from rtphys.physics.domain import Domain
from rtphys.physics.values import REDRAWS, Interval

GLOBAL = load_domain("global")
SEEDS = range(200)


@pytest.mark.parametrize("key", GLOBAL.keys)
def test_one_attribute_alone_draws_what_it_draws_in_company(key):
    for seed in range(20):
        alone, all_together = GLOBAL.sample(seed, only=[key]), GLOBAL.sample(seed)
        if alone["camera_mode"] not in (None, all_together["camera_mode"]):
            continue  # alone a camera always moves, beside others only in its own modes
        assert alone[key] == all_together[key]
        assert alone.varied == {key}


def test_a_removed_rule_moves_no_other_draw():
    fewer = Domain("fewer", {k: r for k, r in GLOBAL.rules.items() if k != "object_mass"})
    a, b = GLOBAL.sample(7), fewer.sample(7)
    assert {k for k in a if a[k] != b[k]} == {"object_mass"}


def test_nothing_varies_in_clean():
    physics = GLOBAL.sample(5, only=[])
    assert physics.varied == frozenset()
    assert physics["camera_mode"] is None
    assert physics["friction"] == 0.5
    assert physics["object_joint_damping"] is None
    assert physics["center_of_mass"] == (0.0, 0.0, 0.0)
    assert physics["object_mass"] == 1.0


def test_every_draw_is_in_the_domain():
    rules = {k: r for k, r in GLOBAL.rules.items() if not isinstance(r, SameAs)}
    for seed in SEEDS:
        physics = GLOBAL.sample(seed)
        assert all(physics[key] in rule for key, rule in rules.items())


def test_gripper_has_the_arms_draw():
    for seed in range(20):
        physics = GLOBAL.sample(seed)
        assert physics["gripper_joint_damping"] == physics["arm_joint_damping"]
    alone = GLOBAL.sample(4, only=["gripper_joint_damping"])
    assert alone["gripper_joint_damping"] == GLOBAL.sample(4)["arm_joint_damping"]
    assert alone["arm_joint_damping"] == 1.0
    held = GLOBAL.sample(4, overrides={"arm_joint_damping": 2.5})
    assert held["gripper_joint_damping"] == GLOBAL.sample(4)["arm_joint_damping"]


def modes(**asked):
    return {GLOBAL.sample(seed, **asked)["camera_mode"] for seed in range(60)}


def test_camera_modes_suit_what_is_active():
    assert modes() == {"orbit", "shift", "rotate"}
    assert modes(only=["camera_distance"]) == {"orbit", "shift"}
    assert modes(only=["camera_angle"]) == {"rotate"}
    assert modes(only=["friction"]) == {None}
    assert modes(overrides={"camera_distance": 0.05}) == {"orbit"}
    assert modes(overrides={"camera_distance": 0.03}) == {"orbit", "shift"}
    assert modes(overrides={"camera_distance": 0.3}) == {"orbit"}  # outside, the widest
    assert modes(overrides={"camera_distance": 0.0}) == {"rotate"}
    assert modes(overrides={"camera_angle": 5.0}) == {"rotate"}
    assert modes(overrides={"camera_mode": "shift"}) == {"shift"}
    assert modes(only=[], overrides={"camera_distance": 0.0}) == {"orbit", "shift", "rotate"}


def test_a_mode_comes_with_its_direction_whoever_asks_for_it():
    """Held, or a rule of another attribute by it; the draws are those of a moving camera."""
    branches = {mode: Fixed(value) for mode, value in (("orbit", 0.2), ("shift", 0.5))}
    by = By("camera_mode", {**branches, "rotate": Fixed(0.8)})
    sorted_by_mode = Domain("by", {**GLOBAL.rules, "friction": by})
    for seed in range(30):
        whole = GLOBAL.sample(seed)
        held = GLOBAL.sample(seed, only=[], overrides={"camera_mode": "orbit"})
        assert held["camera_direction"] == whole["camera_direction"]
        assert held.varied == frozenset()
        chosen = sorted_by_mode.sample(seed, only=["friction"])
        assert chosen["friction"] == by.branches[str(chosen["camera_mode"])].value
        assert chosen["camera_direction"] == whole["camera_direction"]
        assert sorted_by_mode.sample(seed)["camera_mode"] == whole["camera_mode"]


def test_distance_and_angle_exclude_each_other():
    for seed in SEEDS:
        physics = GLOBAL.sample(seed)
        assert physics["camera_distance"] == 0 or physics["camera_angle"] == 0
    with pytest.raises(BadValue, match="no camera_mode has it together with"):
        GLOBAL.sample(1, overrides={"camera_distance": 0.05, "camera_angle": 5.0})


def test_camera_direction_is_a_unit_vector():
    directions = np.array([GLOBAL.sample(seed)["camera_direction"] for seed in range(1000)])
    assert np.allclose(np.linalg.norm(directions, axis=1), 1)
    assert np.all(np.abs(directions.mean(axis=0)) < 0.08)  # 4 sigma of uniform on the sphere


def test_overrides_may_leave_the_domain_but_not_the_simulator():
    assert GLOBAL.sample(1, overrides={"friction": 2.0})["friction"] == 2.0
    with pytest.raises(BadValue, match=r"friction = 9.0 is not .* a number in \[0, 4\]"):
        GLOBAL.sample(1, overrides={"friction": 9.0})
    with pytest.raises(BadValue, match="it is 3 numbers, each"):
        GLOBAL.sample(1, overrides={"center_of_mass": 0.01})
    with pytest.raises(UnknownName, match="did you mean 'friction'"):
        GLOBAL.sample(1, overrides={"frition": 0.1})
    with pytest.raises(UnknownName, match="did you mean 'friction'"):
        GLOBAL.sample(1, only=["frition"])
    quiet = Domain("quiet", {"friction": Uniform(Interval(0, 1))})
    with pytest.raises(UnknownName, match="attribute of domain quiet 'object_mass'"):
        quiet.sample(1, only=["object_mass"])


def test_center_of_mass_is_redrawn_from_its_own_stream():
    def in_the_upper_half(com, _):
        return com[2] > 0

    counts = []
    for seed in SEEDS:
        free, physics = GLOBAL.sample(seed), GLOBAL.sample(seed, inside=in_the_upper_half)
        assert physics.vector("center_of_mass")[2] > 0
        redraws = int(physics.scalar("center_of_mass_redraws"))
        assert (redraws == 0) == (free == physics)
        changed = {k for k in free if free[k] != physics[k]}
        assert changed <= {"center_of_mass", "center_of_mass_redraws"}
        assert GLOBAL.sample(seed, inside=after({REDRAWS: redraws})) == physics
        counts.append(redraws)
    assert 0.6 < np.mean(counts) < 1.5  # geometric with p = 1/2 has mean 1


def test_a_center_of_mass_that_fits_nowhere():
    with pytest.raises(Infeasible) as caught:
        GLOBAL.sample(1, inside=lambda com, _: False)
    assert caught.value.reason == "invalid_physics"
    held = {"center_of_mass": (0.05, 0.0, 0.0)}  # `prepare` says whether it fits
    assert GLOBAL.sample(1, overrides=held, inside=lambda com, _: False)["center_of_mass"] == (
        0.05,
        0,
        0,
    )


def test_fixed_stands_for_every_component():
    domain = Domain("fixed", {"center_of_mass": Fixed(0.001)})
    assert domain.sample(1)["center_of_mass"] == (0.001, 0.001, 0.001)


def test_the_smallest_scale_is_that_of_the_rule_which_is_followed():
    rules = {"object_mass": Uniform(Interval(0.5, 2)), "object_scale": SameAs("object_mass")}
    assert Domain("own", rules).smallest_scale == 0.5
    assert Domain("own", {}).smallest_scale == 1.0
