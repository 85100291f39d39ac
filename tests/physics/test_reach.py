"""Physics of single props: keys, draws, domains, and what is refused by name."""

from dataclasses import replace
from pathlib import Path

import pytest

from rtphys.core.errors import BadValue, UnknownName
from rtphys.core.poses import Pose
from rtphys.physics import after, could_act, load_domain, parse_overrides
from rtphys.physics.distribution import SameAs
from rtphys.physics.domain import Domain
from rtphys.physics.pair import of_two
from rtphys.physics.reach import Reach, keys_of, reach
from rtphys.physics.values import REDRAWS, Vector
from rtphys.task.props import Articulated, Box, check_props, parts

GLOBAL = load_domain("global")
BLOCK = Box(name="block", pose=Pose((0, 0, 0)), half_size=(0.02, 0.02, 0.02))
MARK = Box(name="mark", pose=Pose((0, 0, 0)), half_size=(0.02, 0.02, 0.0), visual_only=True)
DOOR = Articulated(name="door", pose=Pose((0, 0, 0)), category="015_laptop", model=0, fixed=True)


def domain(folder: Path, rules: str, name: str = "own"):
    path = folder / f"{name}.yaml"
    path.write_text(f"extends: global\nphysics:\n{rules}")
    return load_domain(path)


def test_a_key_is_for_its_prop_or_for_all_without_one() -> None:
    keys = ("friction", "friction@a", "object_mass", "object_mass@b")
    assert keys_of("friction", keys) == ["friction", "friction@a"]
    assert [n for n in ("a", "a/lid", "ab", "table") if reach("friction@a", keys).has(n)] == [
        "a",
        "a/lid",
    ]
    assert [n for n in ("a", "a/lid", "ab", "table") if reach("friction", keys).has(n)] == [
        "ab",
        "table",
    ]


def test_a_prop_draws_from_its_own_stream(tmp_path: Path) -> None:
    own = domain(
        tmp_path, "  friction@a: {uniform: [0.1, 0.2]}\n  friction@b: {uniform: [1, 1.2]}\n"
    )
    for seed in range(20):
        before, drawn = GLOBAL.sample(seed), own.sample(seed)
        assert 0.1 <= drawn.scalar("friction@a") <= 0.2 < 1 <= drawn.scalar("friction@b") <= 1.2
        assert all(drawn[key] == value for key, value in before.items())
        assert drawn.varied == before.varied | {"friction@a", "friction@b"}
        held = own.sample(seed, overrides={"friction@a": 0.7})
        assert held["friction@b"] == drawn["friction@b"]
        assert (held.of("friction", "a"), held.of("friction", "c")) == (0.7, drawn["friction"])


def test_a_prop_that_follows_what_a_protocol_leaves_out_has_that_rule_itself(
    tmp_path: Path,
) -> None:
    own = domain(tmp_path, "  restitution: {uniform: [0.1, 0.2]}\n")
    own = replace(own, rules={**own.rules, "restitution@a": SameAs("restitution")})
    alone = own.by_prop
    assert 0.1 <= alone.sample(1).scalar("restitution@a") <= 0.2
    assert alone.rule("restitution@a") == own.rules["restitution"]


DEAL = "  friction@a,b: {deal: [{uniform: [0.1, 0.2]}, {uniform: [1, 1.2]}]}\n"


def test_props_are_dealt_one_rule_each(tmp_path: Path) -> None:
    own = domain(tmp_path, DEAL)
    drawn = [own.sample(seed) for seed in range(200)]
    slippery = [p.scalar("friction@a") < p.scalar("friction@b") for p in drawn]
    assert 70 < sum(slippery) < 130, "either prop, as often"
    for seed, physics in enumerate(drawn):
        low, high = sorted(physics.scalar(f"friction@{prop}") for prop in "ab")
        assert 0.1 <= low <= 0.2 < 1 <= high <= 1.2
        held = own.sample(seed, overrides={"friction@a": 0.7})
        assert held["friction@b"] == physics["friction@b"]
        assert physics["friction"] == GLOBAL.sample(seed)["friction"]
    again = Domain.from_json(own.to_json())
    assert again.digest == own.digest and [again.sample(s) for s in range(200)] == drawn


def own_centres(folder: Path, rules: str) -> Domain:
    path = folder / "centres.yaml"
    path.write_text(f"physics:\n{rules}")
    return load_domain(path)


def test_centres_of_mass_are_dealt_and_drawn_again_by_the_same_rule(tmp_path: Path) -> None:
    rules = "  center_of_mass@a,b: {deal: [{uniform: [-0.02, -0.01]}, {uniform: [0.01, 0.02]}]}\n"
    own = own_centres(tmp_path, rules)
    for seed in range(50):
        first, other = own.sample(seed), own.sample(seed, inside=after({f"{REDRAWS}@a": 2}))
        for physics in (first, other):
            a, b = physics.vector("center_of_mass@a"), physics.vector("center_of_mass@b")
            assert (min(a) < 0) == (max(a) < 0) != (min(b) < 0) == (max(b) < 0)
        assert other["center_of_mass@b"] == first["center_of_mass@b"]
        assert other["center_of_mass@a"] != first["center_of_mass@a"]


def test_a_centre_of_mass_that_follows_another_is_the_same_after_redraws(tmp_path: Path) -> None:
    """It lies inside the bodies of both, also where one is held."""
    rules = "  center_of_mass@a: {uniform: [-0.01, 0.01]}\n"
    own = own_centres(tmp_path, f"{rules}  center_of_mass@b: {{same_as: center_of_mass@a}}\n")

    def inside(offset: Vector, bodies: Reach) -> bool:
        return offset[0] > 0.002 if bodies.has("a") else offset[1] > 0.002

    for seed in range(50):
        drawn = own.sample(seed, inside=inside)
        assert min(drawn.vector("center_of_mass@a")[:2]) > 0.002  # of both
        assert drawn["center_of_mass@b"] == drawn["center_of_mass@a"]
        held = own.sample(seed, overrides={"center_of_mass@b": (0, 0, 0)}, inside=inside)
        assert held["center_of_mass@a"] == drawn["center_of_mass@a"]
        redraws = {key: drawn[key] for key in (f"{REDRAWS}@a", f"{REDRAWS}@b")}
        assert own.sample(seed, inside=after(redraws)) == drawn  # type: ignore[arg-type]


@pytest.mark.parametrize(
    ("rules", "problem"),
    [
        ("  friction@a: {deal: [0.1, 0.2]}\n", "as many rules as its key names props"),
        ("  friction@a,b: {deal: [0.1]}\n", "as many rules as its key names props"),
        ("  friction@a,b: {deal: 3}\n", "as many rules as its key names props"),
        ("  friction@a,b: {deal: [0.1, {same_as: friction}]}\n", "plain distributions"),
        ("  friction@a,b: {deal: [0.1, 9]}\n", r"friction@a = 9.0 .* a number in \[0, 2\]"),
    ],
)
def test_a_deal_that_cannot_be_is_refused(tmp_path: Path, rules: str, problem: str) -> None:
    with pytest.raises(BadValue, match=problem):
        domain(tmp_path, rules)


def test_several_props_may_share_a_rule_and_draw_by_themselves(tmp_path: Path) -> None:
    own = domain(tmp_path, "  friction@a,b: {uniform: [0.1, 0.2]}\n")
    assert own.sample(1)["friction@a"] != own.sample(1)["friction@b"]


def test_only_names_a_prop_or_the_whole_attribute(tmp_path: Path) -> None:
    own = domain(tmp_path, "  friction@a: 0.1\n  friction@b: 0.2\n  object_mass@a: 2\n")
    assert own.sample(1, only=["friction@a"]).varied == {"friction@a"}
    assert own.sample(1, only=["friction"]).varied == {"friction", "friction@a", "friction@b"}
    hidden = {"friction@a", "friction@b", "object_mass@a"}
    assert {*own.of(["restitution"]).keys} == {"restitution", *hidden}
    assert {*own.by_prop.keys} == hidden, "every protocol draws them"
    assert own.narrowed(0.25).rules["friction@b"] == own.rules["friction@b"], "and none narrows"
    with pytest.raises(UnknownName, match="did you mean 'friction@b'"):
        own.sample(1, only=["friction@bb"])


def test_a_centre_of_mass_is_redrawn_for_the_bodies_that_it_is_for(tmp_path: Path) -> None:
    own = domain(tmp_path, "  center_of_mass@bar: {uniform: [-0.01, 0.01]}\n")

    def fits(offset, of) -> bool:
        return offset[0] > 0 if of.has("bar/end") else offset[2] > 0

    for seed in range(20):
        drawn = own.sample(seed, inside=fits)
        assert drawn.vector("center_of_mass@bar")[0] > 0 < drawn.vector("center_of_mass")[2]
        redraws = {key: int(drawn.scalar(key)) for key in keys_of(REDRAWS, drawn)}
        assert redraws.keys() == {REDRAWS, f"{REDRAWS}@bar"}
        assert own.sample(seed, inside=after(redraws)) == drawn


def test_what_acts_is_asked_of_each_prop() -> None:
    held = {"object_mass@block": 2.0, "object_joint_damping@door": 3.0, "friction@block": 0.2}
    physics = GLOBAL.sample(1, only=[], overrides=held)
    acts = could_act(physics, parts([BLOCK, MARK]))
    assert {"object_mass@block", "friction@block", "friction"} <= acts
    assert "object_joint_damping@door" not in acts
    assert "object_mass" in acts, "the mark has what is left"
    assert "object_mass" not in could_act(physics, parts([BLOCK]))


def test_two_props_that_differ() -> None:
    assert of_two(0.2, 0.8, 0.2) == pytest.approx(0.8)
    assert of_two(0.5, 0.5, 0.5) == 0.5


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("frition@a=1", "unknown attribute 'frition'; did you mean 'friction'"),
        ("table_tilt@a=1", "attribute of one prop in 'table_tilt@a'"),
        ("friction@=1", "write the prop behind @"),
        ("restitution@a=0.7", r"restitution@a = 0.7 is not .* in \[0, 0.5\]"),
        ("friction@a=0.1,0.2", "friction@a = .* a number in"),
    ],
)
def test_a_key_that_cannot_be_is_refused_by_name(text: str, words: str) -> None:
    with pytest.raises((UnknownName, BadValue), match=words):
        parse_overrides([text])


def test_two_values_of_one_prop_are_refused() -> None:
    with pytest.raises(BadValue, match=r"friction@a is held at 0.1 already"):
        parse_overrides(["friction@a=0.1", "friction@a=0.2"])


def test_a_rule_of_a_prop_narrows_that_of_the_same_prop_alone(tmp_path: Path) -> None:
    wide = "  friction@a: {uniform: [1, 1.5]}\n"  # wider than the global domain's friction
    assert domain(tmp_path, wide, "parent").sample(1).scalar("friction@a") >= 1
    child = tmp_path / "child.yaml"
    child.write_text("extends: parent\nphysics:\n  friction@a: {uniform: [0.9, 1.5]}\n")
    with pytest.raises(BadValue, match=r"friction@a .* domain parent allows \[1, 1.5\]"):
        load_domain(child)


@pytest.mark.parametrize(
    ("rule", "words"),
    [
        ("friction@a: {uniform: [1, 2.5]}", r"own.yaml: friction@a = 2.5 .* in \[0, 2\]"),
        ("camera_angle@a: 1", "own.yaml: unknown attribute of one prop"),
        ("friction@a: 0.1\n  friction@a: 0.2", "own.yaml: broken YAML"),
    ],
)
def test_a_rule_that_cannot_be_is_refused_with_its_file(
    tmp_path: Path, rule: str, words: str
) -> None:
    with pytest.raises(Exception, match=words):
        domain(tmp_path, f"  {rule}\n")


@pytest.mark.parametrize(
    ("key", "words"),
    [
        ("friction@blok", "friction@blok: unknown prop 'blok'; did you mean 'block'"),
        ("friction@mark", "unknown prop that can be touched 'mark'"),
        ("object_joint_damping@block", "unknown prop with joints 'block'.* Known: door"),
    ],
)
def test_a_prop_that_is_not_there_is_refused_with_the_nearest(key: str, words: str) -> None:
    with pytest.raises(UnknownName, match=words):
        check_props([key], [BLOCK, MARK, DOOR])
    check_props(["friction@block", "object_joint_damping@door", "camera_mode"], [BLOCK, DOOR])
