"""What counts as a press: near the point, closed, and from above where a task asks for that."""

from math import pi
from typing import cast

import numpy as np
import pytest

from rtphys.core.poses import Pose, axis_angle
from rtphys.task.scene import Scene
from rtphys.task.success import pressed

BUTTON = Pose((0.1, -0.1, 0.9), (1, 0, 0, 0))


class OneHand:
    """The right hand touches the clock at a point; the left touches nothing."""

    def __init__(self, point: tuple[float, ...], opening: float, pitch: float) -> None:
        self._point, self._opening = np.array([point]), opening
        self._tcp = Pose(BUTTON.p, axis_angle((0, 1, 0), pitch))  # pi/2 points +x down
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


def holds(scene: OneHand, tilted_below: float) -> bool:
    condition = pressed("clock", 0, (0.03, 0.03, 0.03), 0.2, tilted_below)
    return condition.holds(cast(Scene, scene))


@pytest.mark.parametrize(
    ("point", "opening", "pitch", "counts"),
    [
        ((0.12, -0.1, 0.91), 0.1, pi / 2, True),
        ((0.12, -0.1, 0.91), 0.1, pi / 4 + 0.01, True),
        ((0.12, -0.1, 0.91), 0.1, pi / 4 - 0.01, False),  # leans too far
        ((0.12, -0.1, 0.91), 0.1, 0.0, False),  # from the side
        ((0.12, -0.1, 0.91), 0.1, -pi / 2, False),  # from below
        ((0.12, -0.1, 0.91), 0.3, pi / 2, False),  # open
        ((0.14, -0.1, 0.91), 0.1, pi / 2, False),  # beside the button
    ],
)
def test_a_press_is_near_closed_and_from_above(
    point: tuple[float, ...], opening: float, pitch: float, counts: bool
) -> None:
    assert holds(OneHand(point, opening, pitch), pi / 4) is counts


@pytest.mark.parametrize("pitch", [-pi / 2, 0.0, 1.0, pi / 2])
def test_any_direction_counts_unless_a_task_asks(pitch: float) -> None:
    assert holds(OneHand((0.1, -0.1, 0.9), 0.0, pitch), pi)
