"""The instant at which an attempt went wrong, and the holds from which it is found."""

from dataclasses import replace

import numpy as np
import pytest
from hand_tracks import (
    LIFT,
    SHUT,
    T,
    beside,
    during,
    frames_of,
    lifted,
    mark,
    opening,
    put_down,
    resting,
    rolling,
    shoved,
    tipped,
)

from rtphys.episode.failure import went_wrong

NEVER = during(99, 99)
MISSED = "cup is not between the fingers"
LEFT = "cup left the left hand"


BESIDE = frames_of(tipped(resting(), 30), NEVER)  # the cup lies, and last the plate is pushed
BOTH = beside(BESIDE, "plate", shoved(resting(), 50))
PUT_DOWN, LETTING_GO = put_down(45, slow=5)
CLOSING = opening((T - 5, 1.0), (T - 1, 0.7))


def slid_out() -> np.ndarray:
    """The hand goes on without it."""
    cup = lifted(LIFT + 5)
    cup[LIFT + 5 :, 2] = cup[LIFT + 4, 2]
    return cup


def slid_in_passing() -> np.ndarray:
    plate = resting()
    plate[: LIFT + 5, 2] += np.clip(np.arange(LIFT + 5) - LIFT, 0, None) * 0.01
    return plate


# What happened, frames, reason and detail of the attempt -> how the instant begins.
STORIES = {
    "a slide out of the hand shows after a centimetre of the slide that ends badly": (
        frames_of(slid_out(), during(SHUT, LIFT + 9)), "slipped", LEFT,
        ("slip", LIFT + 5, "cup", "left"),
    ),
    "fingers that close on nothing miss": (
        frames_of(resting(), NEVER), "grasp_missed", MISSED, ("miss", SHUT, "cup", "left"),
    ),
    "a miss is due to what was pushed before": (
        frames_of(shoved(resting(), 12), NEVER), "grasp_missed", MISSED, ("moved", 12, "cup"),
    ),
    "or to what tipped over": (
        frames_of(tipped(resting(), 12), NEVER), "grasp_missed", MISSED, ("tip_over", 12, "cup"),
    ),
    "or to what swung round": (
        frames_of(tipped(resting(), 10, (np.cos(0.3), 0, 0, np.sin(0.3))), NEVER),
        "grasp_missed", MISSED, ("moved", 10, "cup"),
    ),
    "a hand that has not shut at the end missed what slid away before": (
        frames_of(rolling(resting(), 6), NEVER, CLOSING), "grasp_missed", MISSED,
        ("moved", 9, "cup"),
    ),
    "and nothing if nothing moved": (
        frames_of(resting(), NEVER, CLOSING), "grasp_missed", MISSED, ("end", T - 1, "", ""),
    ),
    "a hand that shut on its way missed nothing: it is at its end that the grasp fails": (
        frames_of(rolling(resting(), 6), NEVER, opening((0, 1.0), (5, 0.0))), "grasp_missed",
        MISSED, ("moved", 9, "cup"),
    ),
    "a hand that touched another object, which slid in passing, missed this one": (
        beside(frames_of(shoved(resting(), 6), NEVER), "plate", slid_in_passing(),
               during(SHUT, LIFT + 9)),
        "grasp_missed", MISSED, ("moved", 6, "cup"),
    ),
    "what slid away before a hand that did not pick it up is the instant": (
        frames_of(shoved(resting(), 6), during(SHUT, LIFT + 2)), "slipped", LEFT,
        ("moved", 6, "cup"),
    ),
    "arms that have no way on are stuck though something was put down before": (
        frames_of(PUT_DOWN, during(SHUT, 46), LETTING_GO), "unreachable", "the right hand",
        ("stuck", T - 1, "", ""),
    ),
    "what fell was not picked up by a hand that carries it nowhere": (
        frames_of(tipped(resting(), 8), during(T - 2, T), opening((T - 8, 1.0), (T - 1, 0.3))),
        "unreachable", "the right hand", ("tip_over", 8, "cup"),
    ),
    "what was picked up again was no failure of a path": (
        frames_of(shoved(lifted(T), 5), during(SHUT, T)), "no_path", "", ("stuck", T - 1, "", ""),
    ),
    "nor of anything else": (
        frames_of(shoved(lifted(T), 5), during(SHUT, T)), "step_limit", "", ("end", T - 1, "", ""),
    ),
    "what was put down wrong had turned in the hand": (
        frames_of(tipped(PUT_DOWN.copy(), LIFT + 2), during(SHUT, 46), LETTING_GO),
        "failed_check", "cup upright within 0.2 rad", ("slip", LIFT + 2, "cup", "left"),
    ),
    "and does not fall anew": (
        frames_of(
            tipped(tipped(put_down(40)[0], LIFT + 2, (np.cos(0.4), np.sin(0.4), 0, 0)), 55,
                   (0, 1, 0, 0)),
            during(SHUT, 40), put_down(40)[1],
        ),
        "failed_check", "cup upright within 0.2 rad", ("slip", LIFT + 2, "cup"),
    ),
    "what an opened hand still touches is not held: the load rolls off": (
        frames_of(put_down(40)[0], during(SHUT, 40) | during(44, 50), put_down(40, 0.5, 2)[1]),
        "failed_check", "cup on the plate", ("misplaced", 41),
    ),
    "a failed condition says whose failure counts": (
        BOTH, "failed_check", "cup upright within 0.2 rad", ("tip_over", 30, "cup"),
    ),
    "also in the plural": (BOTH, "failed_check", "cups at rest", ("tip_over", 30, "cup")),
    "but not without a name": (BOTH, "failed_check", "a hand carries both", ("moved", 50, "plate")),
    "nor of a joint": (BOTH, "failed_check", "cup joint 0 beyond 50%", ("moved", 50, "plate")),
    "a hand that is to press closes on its way": (
        frames_of(resting(), NEVER), "gave_up", "not true: cup pressed at its point 0",
        ("end", T - 1, "", ""),
    ),
    "but one that is to take as well misses": (
        frames_of(resting(), NEVER), "gave_up", "not true: cup pressed at its point 0; cup at rest",
        ("miss", SHUT, "", "left"),
    ),
    "what pushed the other is the instant": (
        beside(frames_of(tipped(resting(), 50), NEVER), "plate", shoved(resting(), 44)),
        "not_held", "cup at rest", ("moved", 44, "plate"),
    ),
}  # fmt: skip


@pytest.mark.parametrize("story", STORIES)
def test_the_instant_of(story: str) -> None:
    frames, reason, detail, wanted = STORIES[story]
    assert mark(frames, reason, detail)[: len(wanted)] == wanted


def test_a_load_that_falls_at_once_is_a_drop() -> None:
    frames = frames_of(lifted(LIFT + 6), during(SHUT, LIFT + 5))
    event, frame, *_ = mark(frames, "slipped", LEFT)
    assert (event, frame) in {("drop", LIFT + 6), ("slip", LIFT + 6)}


@pytest.mark.parametrize(("wait", "event"), [(0, "misplaced"), (12, "moved")])
def test_what_rolls_away_when_it_is_let_go_of_is_misplaced(wait: int, event: str) -> None:
    cup, hand = put_down(40)
    frames = frames_of(rolling(cup, 41 + wait), during(SHUT, 40), hand)
    found, frame, name, _ = mark(frames, "failed_check", "cup on the plate")
    assert (found, name) == (event, "cup")
    assert frame == 41 if event == "misplaced" else frame > 41 + wait


def test_what_is_let_go_of_in_the_wrong_place_is_misplaced() -> None:
    cup, hand = put_down(45, slow=5)
    frames = frames_of(cup, during(SHUT, 46), hand)
    event, frame, name, side = mark(frames, "failed_check", "cup on the plate")
    assert (event, name, side) == ("misplaced", "cup", "left") and 45 <= frame <= 48


def test_clutter_is_nobodys_failure() -> None:
    frames = frames_of(resting(), NEVER)
    away = frames.object_poses["clutter0"] + np.linspace(0, 1, T)[:, None] * np.eye(7)[0]
    moved = replace(frames, object_poses={**frames.object_poses, "clutter0": away})
    assert mark(moved, "failed_check")[0] == "miss"
    assert went_wrong(moved, "failed_check", "").object == "clutter0"


def test_what_was_lost_twice_went_wrong_the_first_time() -> None:
    cup = lifted(36)
    cup[36:, 2] = cup[35, 2]
    cup[50:, 2] -= 0.1
    twice = during(SHUT, 36) | during(44, 49)
    event, frame, *_ = mark(frames_of(cup, twice), "slipped", LEFT)
    assert event in {"slip", "drop"} and 36 <= frame <= 38


@pytest.mark.parametrize(("with_it", "wanted"), [(True, ("moved", 52)), (False, ("moved", 32))])
def test_what_lies_in_a_carried_object_is_carried(with_it: bool, wanted: tuple[str, int]) -> None:
    """Its ball rolls out of the cup at frame 50; one that is only pushed moves at once."""
    ball, way = resting(), np.clip(np.arange(T) - LIFT, 0, None) * 0.01
    ball[:, 2 if with_it else 0] += way
    ball[50:, 0] += (np.arange(50, T) - 49) * 0.04 * with_it
    both = beside(frames_of(lifted(T), during(SHUT, T)), "ball", ball)
    event, frame, name, _ = mark(both, "failed_check", "ball on the plate")
    assert (event, name) == (wanted[0], "ball") and abs(frame - wanted[1]) <= 3


def test_what_a_hand_brushes_as_it_opens_was_not_let_go_of() -> None:
    _, hand = put_down(45, slow=5)
    frames = frames_of(resting(), during(40, 46), hand)
    assert mark(frames, "failed_check", "cup on the plate")[0] != "misplaced"


@pytest.mark.parametrize(("turning", "wanted"), [(24, (45, 47)), (4, (22, 26))])
def test_a_load_that_sags_is_carried_and_one_that_swings_has_slipped(
    turning: int, wanted: tuple[int, int]
) -> None:
    """It turns by 70 degrees, slowly or at once, and slides out at frame 45."""
    cup = lifted(50)
    half = np.radians(35) * np.clip((np.arange(T) - 21) / turning, 0, 1)
    cup[:, 3], cup[:, 4] = np.cos(half), np.sin(half)
    cup[45:50, 0] += np.arange(1, 6) * 0.01
    event, frame, *_ = mark(frames_of(cup, during(SHUT, 49)), "slipped", LEFT)
    assert event == "slip" and wanted[0] <= frame <= wanted[1]
