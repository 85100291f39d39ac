"""Grasp candidates: hand poses of contact points, their order, and their height over the table."""

import numpy as np
import pytest

from rtphys.assets.embodiment import Hand
from rtphys.core.poses import Pose, axis_angle
from rtphys.expert.grasp import TILTS, candidates, ee_of_contact, preference, raised_clear

HAND = Hand(0.12, 0.0356, 0.0305, 0.01, 0.045, 0.0475, 0.0445)
LONG = Hand(0.2, 0.05, 0.0305, 0.01, 0.045, 0.0475, 0.0445)
TOP = 0.74


def contact(height: float) -> Pose:
    """A contact frame above the table that faces straight up (+y outward)."""
    return Pose((0.1, -0.1, height), axis_angle((1, 0, 0), np.pi / 2))


@pytest.mark.parametrize("hand", [HAND, LONG])
def test_the_tool_centre_point_is_at_the_contact_point(hand: Hand) -> None:
    point = contact(0.9)
    ee = ee_of_contact(point, hand)
    np.testing.assert_allclose(ee @ np.array([hand.tcp, 0, 0]), point.p, atol=1e-12)
    np.testing.assert_allclose(ee.R[:, 0], -point.R[:, 1], atol=1e-12)  # approach
    np.testing.assert_allclose(ee.R[:, 2], point.R[:, 0], atol=1e-12)  # camera-up


@pytest.mark.parametrize("hand", [HAND, LONG])
def test_fingertips_stay_clear_of_the_table(hand: Hand) -> None:
    ee = ee_of_contact(contact(TOP + 0.01), hand)
    raised = raised_clear(ee, TOP, hand)
    tip = raised @ np.array([hand.tip, 0, 0])
    assert tip[2] == pytest.approx(TOP + 0.003)
    np.testing.assert_array_equal(raised.q, ee.q)
    high = ee_of_contact(contact(TOP + 0.1), hand)
    assert raised_clear(high, TOP, hand) is high


def test_a_level_hand_is_not_shifted() -> None:
    level = Pose((0.0, 0.0, TOP))
    assert raised_clear(level, TOP, HAND) is level


def test_candidates_come_best_first_and_once() -> None:
    points = [(0, contact(0.9)), (1, contact(0.9) @ Pose(q=axis_angle((0, 1, 0), np.pi)))]
    grasps = list(candidates(points, "right", TOP, HAND))
    costs = [grasp.cost for grasp in grasps]
    assert costs == sorted(costs)
    assert grasps[0].cost == preference(grasps[0].ee, "right")
    # The second point is the first seen by the flipped hand: nothing new.
    alone = list(candidates(points[:1], "right", TOP, HAND))
    assert len(grasps) == len(alone) == 2 * (2 * len(TILTS) - 1)
    keys = {tuple(np.round([*grasp.ee.p, *np.abs(grasp.ee.q)], 6)) for grasp in grasps}
    assert len(keys) == len(grasps)


def test_each_arm_prefers_a_wrist_turned_inward() -> None:
    point = [(0, contact(0.9) @ Pose(q=axis_angle((0, 1, 0), angle))) for angle in (-0.5, 0.5)]
    left, right = (next(candidates(point, side, TOP, HAND)) for side in ("left", "right"))
    assert left.ee.R[0, 2] > 0 > right.ee.R[0, 2]
