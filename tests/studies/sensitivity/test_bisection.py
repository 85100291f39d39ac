"""The search for the tolerated part of a range, on worlds whose answer is known."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from rtphys.studies.sensitivity.axis import Axis
from rtphys.studies.sensitivity.bisection import Bisection, Level, answer

AXIS = Axis("friction", 0.5, 0.1, {})


def search(threshold: float, steps: int, seeds: int = 10) -> Bisection:
    """All seeds succeed up to a share of the way, none beyond."""
    bisection = Bisection(AXIS, steps)
    while (share := bisection.next) is not None:
        successes = seeds if share <= threshold else 0
        bisection.levels.append(Level(share, successes, seeds))
    return bisection


@given(st.floats(0, 0.999), st.integers(0, 10))
def test_the_answer_is_bracketed_to_the_last_halving(threshold: float, steps: int) -> None:
    found = search(threshold, steps)
    low, high = found.bracket
    assert low <= threshold < high and high - low == pytest.approx(0.5**steps)
    assert len(found.levels) == steps + 1
    assert found.interval == (low, high)


def test_a_range_that_is_tolerated_takes_one_level() -> None:
    found = search(1.0, 5)
    assert found.bracket == (1.0, 1.0) and len(found.levels) == 1
    assert found.to_json()["tolerance"] == 0.1


def test_half_of_the_seeds_holds_but_is_not_sure() -> None:
    found = Bisection(AXIS, 1, [Level(1.0, 0, 10), Level(0.5, 5, 10)])
    assert found.bracket == (0.5, 1.0) and found.interval == (0.0, 1.0)


def test_the_share_of_a_range_counts_both_sides_by_their_width() -> None:
    below, above = search(1.0, 2), Bisection(Axis("friction", 0.5, 1.3, {}), 1)
    above.levels += [Level(1.0, 0, 10), Level(0.5, 10, 10)]
    found = answer([below, above])
    assert found["range"] == [0.1, 1.3] and found["tolerance"] == [0.1, 0.9]
    assert found["share"] == pytest.approx((0.4 + 0.4) / (0.4 + 0.8))
