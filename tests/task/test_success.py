"""Success conditions on scenes that a test states."""

from dataclasses import dataclass, field
from math import pi, tan
from typing import cast

import numpy as np
import pytest

from rtphys.core.poses import Pose, axis_angle
from rtphys.task import Scene, in_either_hand, in_hand
from rtphys.task.success import (
    Condition,
    above,
    at_rest,
    joint_beyond,
    lifted,
    near,
    on_table,
    opened,
    parallel,
    points_meet,
    pressed,
    turned_to,
    upright,
)


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


BUTTON = Pose((0.1, -0.1, 0.9), axis_angle((1, 0, 0), pi / 2))  # +y, outward, is up


class OneHand:
    """The right hand touches the clock at a point; the left touches nothing."""

    def __init__(
        self, point: tuple[float, ...], opening: float, pitch: float, tcp: tuple[float, float]
    ) -> None:
        self._point, self._opening = np.array([point]), opening
        above = BUTTON.p + np.array([tcp[0], 0.0, tcp[1]])
        self._tcp = Pose(above, axis_angle((0, 1, 0), pitch))  # pi/2 points +x down
        self._seen = False

    def contact_points(self, a: str, b: str) -> np.ndarray:
        return self._point if a == "right_gripper" else np.empty((0, 3))

    def contact(self, prop: str, index: int = 0) -> Pose:
        return BUTTON

    def opening(self, side: str) -> float:
        return self._opening

    def tcp(self, side: str) -> Pose:
        return self._tcp

    def once(self, name: str, now: bool) -> bool:
        self._seen = self._seen or now
        return self._seen


def leaning(angle: float, height: float = 0.04) -> tuple[float, float]:
    """Where the TCP of a hand that leans by an angle [rad] points at the button."""
    return (-height * tan(angle), height)


@pytest.mark.parametrize(
    ("point", "opening", "pitch", "tcp", "counts"),
    [
        ((0.12, -0.1, 0.91), 0.05, pi / 2, (0.0, 0.04), True),
        ((0.12, -0.1, 0.91), 0.05, pi / 2 - 0.54, leaning(0.54), True),
        ((0.12, -0.1, 0.91), 0.05, pi / 2 - 0.56, leaning(0.56), False),  # leans too far
        ((0.12, -0.1, 0.91), 0.05, pi / 2 - 0.54, (0.0, 0.04), False),  # leans, and points past it
        ((0.12, -0.1, 0.91), 0.05, 0.0, (0.0, 0.04), False),  # from the side
        ((0.12, -0.1, 0.91), 0.05, -pi / 2, (0.0, 0.04), False),  # from below
        ((0.12, -0.1, 0.91), 0.15, pi / 2, (0.0, 0.04), False),  # open
        ((0.14, -0.1, 0.91), 0.05, pi / 2, (0.0, 0.04), False),  # beside the button
        ((0.12, -0.1, 0.91), 0.05, pi / 2, (0.0, 0.01), False),  # it scrapes past, beside the clock
        ((0.12, -0.1, 0.91), 0.05, pi / 2, (0.009, 0.04), True),
        ((0.12, -0.1, 0.91), 0.05, pi / 2, (0.011, 0.04), False),  # not over the button
    ],
)
def test_a_press_is_near_closed_and_from_above(
    point: tuple[float, ...],
    opening: float,
    pitch: float,
    tcp: tuple[float, float],
    counts: bool,
) -> None:
    condition = pressed("clock", 0, (0.03, 0.03, 0.03))
    assert condition.holds(cast(Scene, OneHand(point, opening, pitch, tcp))) is counts


class Leaning:
    """Everything leans by 0.3 rad about y, 0.1 m right of the middle and 0.9 m up, and moves."""

    frame = Pose((0.1, 0.0, 0.9), axis_angle((0, 1, 0), 0.3))

    def pose(self, prop: str, link: str = "") -> Pose:
        return self.frame

    def functional(self, prop: str, index: int = 0) -> Pose:
        return Pose((0.02 * index, 0.0, 0.0))

    def lowest(self, prop: str) -> float:
        return 0.8

    def speed(self, prop: str) -> float:
        return 0.07

    def opening(self, side: str) -> float:
        return 0.5

    def joint(self, prop: str, index: int = 0) -> tuple[float, float, float]:
        return 0.5, 0.0, 2.0


@pytest.mark.parametrize(
    ("condition", "said"),
    [
        (near("a", (0, 0, 0.9), within=(0.05, 1, 1)), "off by 0.100, 0.000, 0.000 m"),
        (points_meet("a", 1, "b", 0, (0.01, 1, 1)), "off by 0.020, 0.000, 0.000 m"),
        (on_table("a"), "higher by 0.060 m"),
        (above("a", 1.0), "at 0.900 m"),
        (lifted("a", 0.1), "by 0.060 m"),
        (opened("left"), "50% of 80%"),
        (at_rest("a"), "0.07 m/s"),
        (upright("a", 2, 0.2), "0.30 rad"),
        (parallel("a", 2, (0, 0, -1), 0.2), "0.30 rad"),
        (turned_to("a", (1, 0, 0, 0), 0.2), "0.30 rad"),
        (joint_beyond("a", 0.4), "25%"),
    ],
    ids=lambda value: value.text if isinstance(value, Condition) else "",
)
def test_a_condition_that_fails_says_what_was_measured(condition: Condition, said: str) -> None:
    assert condition.failing(cast(Scene, Leaning())) == [f"{condition.text} ({said})"]


def test_a_condition_without_a_measure_says_its_text() -> None:
    assert in_either_hand("mug").failing(scene()) == ["the mug is in a hand"]
