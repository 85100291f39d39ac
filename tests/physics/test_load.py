"""Reading domain files: inheritance, narrowing, and the words of every refusal."""

import json

import pytest

from rtphys.core.errors import BadFile, BadValue, UnknownName
from rtphys.physics import Domain, load_domain
from rtphys.physics.distribution import Fixed


@pytest.fixture
def write(tmp_path):
    def _write(text, name="mine"):
        path = tmp_path / f"{name}.yaml"
        path.write_text(text)
        return path

    return _write


def refused(path, error):
    with pytest.raises(error) as caught:
        load_domain(path)
    return str(caught.value).replace(str(path), "FILE")


def test_child_replaces_whole_rules_and_says_where_from(write):
    domain = load_domain(write("extends: global\nphysics: {friction: {uniform: [0.2, 0.4]}}\n"))
    assert str(domain.rules["friction"]) == "[0.2, 0.4]"
    assert domain.sources["friction"] == "mine"
    assert domain.sources["object_mass"] == "global"


def test_null_holds_an_attribute_at_nominal(write):
    domain = load_domain(write("extends: global\nphysics: {friction: null, restitution: null}\n"))
    physics = domain.sample(1)
    assert physics["friction"] == 0.5
    assert physics["restitution"] == 0.0
    assert not {"friction", "restitution"} & physics.varied


def test_chain_of_three(write, tmp_path):
    write("extends: global\nphysics: {friction: {uniform: [0.2, 0.8]}}\n", "middle")
    leaf = write("extends: middle\nphysics: {friction: 0.5}\n", "leaf")
    assert load_domain(leaf).rules["friction"] == Fixed(0.5)
    wide = write("extends: middle\nphysics: {friction: 0.9}\n", "wide")
    assert "domain middle allows [0.2, 0.8]" in refused(wide, BadValue)


def test_without_a_parent_any_possible_range_will_do(write):
    domain = load_domain(write("physics: {friction: {log_uniform: [0.001, 3]}}\n"))
    assert domain.keys == ["friction"]
    assert 0.001 <= domain.sample(5).scalar("friction") <= 3


@pytest.mark.parametrize(
    ("rule", "kept"),
    [
        ("friction: {uniform: [0.005, 1.0]}", False),
        ("friction: {uniform: [0.01, 1.25]}", True),
        ("friction: {log_uniform: [0.01, 1.25]}", True),
        ("friction: {choice: [0.1, 1.2]}", True),
        ("friction: {choice: [0.1, 1.3]}", False),
        ("friction: 1.26", False),
        ("center_of_mass: [0, 0, 0.01]", True),
        ("center_of_mass: [0, 0, 0.016]", False),
        ("camera_mode: orbit", True),
        ("camera_mode: {choice: [orbit, rotate]}", True),
        ("camera_distance: 0", True),
        ("camera_distance: {uniform: [0, 0.02]}", False),  # mode rotate holds it at 0
        ("gripper_joint_damping: 2", True),
        ("gripper_joint_damping: 4", False),
        ("arm_joint_damping: {uniform: [1, 2]}", True),
    ],
)
def test_a_child_may_only_narrow(write, rule, kept):
    path = write(f"extends: global\nphysics: {{{rule}}}\n")
    if kept:
        load_domain(path)
    else:
        key = rule.partition(":")[0]
        text = refused(path, BadValue)
        assert text.startswith(f"FILE: {key} = ")
        assert "domain global allows" in text
        assert "may only narrow" in text


REFUSALS = {
    "physics: {frictoin: 1}": "FILE: unknown attribute 'frictoin'; did you mean 'friction'?",
    "extend: global": "FILE: unknown field 'extend'; did you mean 'extends'?",
    "extends: globl": "FILE: unknown domain 'globl'; did you mean 'global'?",
    "physics: {friction: {unifrom: [0, 1]}}": "'unifrom' is no distribution that fits [0, 1]",
    "physics: {friction: {uniform: [1, 0]}}": "[1.0, 0.0] is not an interval",
    "physics: {friction: {uniform: [0, .nan]}}": "nan is not finite",
    "physics: {friction: {uniform: [0, 1], fixed: 2}}": "a rule has exactly one key",
    "physics: {friction: {log_uniform: [0, 1]}}": "log_uniform needs a positive lower end",
    "physics: {friction: slippery}": "it is a number in [0, 4]",
    "physics: {friction: 5}": "FILE: friction = 5.0 is not allowed; it is a number in [0, 4]",
    "physics: {friction: true}": "True is not a number",
    "physics: {friction: {direction: 3}}": "an attribute needs numbers",
    "physics: {friction: [1, 1, 1]}": "it is a number in [0, 4]",
    "physics: {restitution: {choice: []}}": "choice needs a list of at least one",
    "physics: {restitution: {choice: [0.1, 0.1]}}": "a choice is listed twice",
    "physics: {friction: {same_as: restitutoin}}": "unknown source of friction 'restitutoin'",
    "physics: {camera_mode: {choice: [orbit, pan]}}": "it is one of orbit, shift, rotate",
    "physics: {camera_angle: {by: {camera_mode: {orbit: 1}}}}": "rule for camera_mode shift",
    "physics: {camera_angle: {by: {table_tilt: {a: 1}}}}": "unknown selector 'table_tilt'",
    "physics: {friction@a: 1, 'friction@b,a': 0.5}": "FILE: has two rules for friction@a: "
    "friction@a and friction@b,a; keep one",
    "extends: global\nphysics: {arm_joint_damping: null}": "unknown source of "
    "gripper_joint_damping 'arm_joint_damping'",
    "physics: [friction]": "physics must be a mapping",
    "extends: [a, b]": "extends needs the name of one domain",
}


@pytest.mark.parametrize(("text", "words"), REFUSALS.items())
def test_refusals_name_file_key_value_and_what_is_allowed(write, text, words):
    assert words in refused(write(text), (BadValue, UnknownName, BadFile))


def test_a_domain_that_extends_itself(write):
    assert "in a circle" in refused(write("extends: mine\n"), BadFile)


def test_a_file_that_is_not_there(tmp_path):
    with pytest.raises(BadFile, match="nowhere"):
        load_domain(tmp_path / "nowhere.yaml")


def test_json_round_trip_keeps_the_digest():
    for name in ("global", "scan_object", "put_object_cabinet"):
        domain = load_domain(name)
        again = Domain.from_json(json.loads(json.dumps(domain.to_json())))
        assert again.digest == domain.digest
        assert again.sample(3) == domain.sample(3)
        assert again.sources == domain.sources
