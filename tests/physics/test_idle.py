"""Why an attribute could not act: nothing of its kind, or nothing that is left to it."""

import pytest

from rtphys.physics.attribute import Part
from rtphys.physics.idle import why_idle

BLOCKS: dict[str, frozenset[Part]] = {
    "first": frozenset({"bodies", "surfaces"}),
    "second": frozenset({"bodies", "surfaces"}),
    "shelf": frozenset({"surfaces"}),
}


@pytest.mark.parametrize(
    ("key", "keys", "why"),
    [
        ("object_mass", ["object_mass"], ""),
        ("object_mass", ["object_mass", "object_mass@first"], ""),
        (
            "object_mass",
            ["object_mass", "object_mass@first", "object_mass@second"],
            "every object that can move has its own value (object_mass@first, object_mass@second)",
        ),
        ("object_mass@first", ["object_mass@first", "object_mass@second"], ""),
        ("object_mass@shelf", ["object_mass@shelf"], "there is no object that can move"),
        ("object_joint_damping", [], "there is no object with joints"),
        ("friction", ["friction@first", "friction@second", "friction@shelf"], ""),
    ],
)
def test_why(key: str, keys: list[str], why: str) -> None:
    assert why_idle(key, keys, BLOCKS) == why


def test_a_camera_attribute_is_no_mode_yet_where_it_is_drawn_or_held() -> None:
    assert why_idle("camera_angle", [], {}) == why_idle("camera_angle", [], {}, 8.0) == ""
