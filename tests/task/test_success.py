"""What "in a hand" means."""

from dataclasses import dataclass, field
from typing import cast

import pytest

from rtphys.task import Scene, in_either_hand, in_hand


@dataclass
class Grippers:
    """A scene in which some grippers press on a mug."""

    pressing: set[str] = field(default_factory=set)

    def touching(self, a: str, b: str) -> bool:
        return b == "mug" and a.removesuffix("_gripper") in self.pressing


def scene(*sides: str) -> Scene:
    return cast(Scene, Grippers(set(sides)))


@pytest.mark.parametrize("side", ["left", "right"])
def test_either_hand_counts_unless_sides_are_named(side: str) -> None:
    other = {"left": "right", "right": "left"}[side]
    assert in_hand(scene(side), "mug")
    assert in_hand(scene(side), "mug", side)
    assert not in_hand(scene(side), "mug", other)
    assert in_hand(scene(side), "mug", other, side)
    assert not in_hand(scene(side), "cup")
    assert not in_hand(scene(), "mug")


def test_the_condition_names_the_prop() -> None:
    condition = in_either_hand("mug")
    assert condition.text == "the mug is in a hand"
    assert condition.holds(scene("right"))
    assert not condition.holds(scene())
