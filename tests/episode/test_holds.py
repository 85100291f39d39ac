"""What counts as held, carried and slipped, by the instant at which the attempt went wrong."""

from dataclasses import replace

import numpy as np
import pytest
from hand_tracks import LIFT, SHUT, T, during, frames_of, lifted, mark, resting


def test_what_fell_was_not_picked_up_by_a_hand_that_carries_it_nowhere() -> None:
    opening = np.interp(np.arange(T), [T - 8, T - 1], [1.0, 0.3])
    cup = resting()
    cup[8:, 3:] = [0.7, 0.7, 0, 0]
    frames = frames_of(cup, during(T - 2, T), opening)
    assert mark(frames, "unreachable", "the right hand")[:3] == ("tip_over", 8, "cup")


@pytest.mark.parametrize(("with_it", "wanted"), [(True, ("moved", 52)), (False, ("moved", 32))])
def test_what_lies_in_a_carried_object_is_carried(with_it: bool, wanted: tuple[str, int]) -> None:
    """Its ball rolls out of the cup at frame 50; one that is only pushed moves at once."""
    ball, way = resting(), np.clip(np.arange(T) - LIFT, 0, None) * 0.01
    ball[:, 2 if with_it else 0] += way
    ball[50:, 0] += (np.arange(50, T) - 49) * 0.04 * with_it
    frames = frames_of(lifted(T), during(SHUT, T))
    both = replace(
        frames,
        object_poses={**frames.object_poses, "ball": ball},
        contacts={**frames.contacts, "ball": np.zeros((T, 2), bool)},
    )
    event, frame, name, _ = mark(both, "failed_check", "ball on the plate")
    assert (event, name) == (wanted[0], "ball") and abs(frame - wanted[1]) <= 3


def test_what_a_hand_brushes_as_it_opens_was_not_let_go_of() -> None:
    opening = np.interp(np.arange(T), [SHUT - 8, SHUT, 45, 50], [1.0, 0.0, 0.0, 1.0])
    frames = frames_of(resting(), during(40, 46), opening)
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
    event, frame, *_ = mark(frames_of(cup, during(SHUT, 49)), "slipped", "cup left the left hand")
    assert event == "slip" and wanted[0] <= frame <= wanted[1]


def test_what_an_opened_hand_touches_is_not_held() -> None:
    """It opens half way, and the load rolls off while it still touches a finger."""
    opening = np.interp(np.arange(T), [SHUT - 8, SHUT, 40, 42], [1.0, 0.0, 0.0, 0.5])
    cup = lifted(41)
    cup[41:, 2] = cup[40, 2]
    frames = frames_of(cup, during(SHUT, 40) | during(44, 50), opening)
    assert mark(frames, "failed_check", "cup on the plate")[:2] == ("misplaced", 41)
