"""Physics: immutable, and it travels between processes; values from texts and from JSON."""

import pickle

import pytest

from rtphys.core.errors import BadValue, UnknownName
from rtphys.physics import load_domain, parse_overrides
from rtphys.physics.values import plain_value


def test_pickle_round_trip():
    physics = load_domain("global").sample(3)
    again = pickle.loads(pickle.dumps(physics))
    assert again == physics
    assert hash(again) == hash(physics)


def test_immutable():
    physics = load_domain("global").sample(3)
    with pytest.raises(TypeError):
        physics["friction"] = 1.0  # type: ignore[index]
    with pytest.raises(AttributeError):
        physics.more = 1  # type: ignore[attr-defined]


def test_a_key_that_is_not_there_is_named_with_the_nearest():
    clean = load_domain("global").sample(1, only=[])
    with pytest.raises(KeyError, match="unknown attribute 'frction'; did you mean 'friction'"):
        clean["frction"]
    assert "frction" not in clean
    assert clean.get("frction") is None


def test_scalar_and_vector():
    clean = load_domain("global").sample(1, only=[])
    assert clean.scalar("object_mass") == 1.0
    assert clean.scalar("object_joint_damping", 0.5) == 0.5
    assert clean.vector("center_of_mass") == (0, 0, 0)
    with pytest.raises(TypeError, match="object_joint_damping is None"):
        clean.scalar("object_joint_damping")
    with pytest.raises(TypeError, match="not a vector"):
        clean.vector("object_mass")


@pytest.mark.parametrize("bad", [{}, [], ["a", "b"], [1, True], True])
def test_what_is_no_value_is_refused(bad):
    with pytest.raises(ValueError, match="is neither a number, a name, a vector nor null"):
        plain_value(bad)


def test_command_line_values():
    texts = ["friction=0.2", "center_of_mass=0,0,0.01", "camera_mode=orbit"]
    assert parse_overrides(texts) == {
        "friction": 0.2,
        "center_of_mass": (0.0, 0.0, 0.01),
        "camera_mode": "orbit",
    }
    with pytest.raises(UnknownName, match="did you mean 'restitution'"):
        parse_overrides(["restitutoin=0.2"])
    for text, words in {
        "friction": "write key=value",
        "friction=ice": "it needs a number",
        "friction=9": "it is a number in",
        "friction=nan": "it is a number in",
        "center_of_mass=0,0": "it is 3 numbers",
        "camera_mode=pan": "it is one of orbit, shift, rotate",
    }.items():
        with pytest.raises(BadValue, match=words):
            parse_overrides([text])
