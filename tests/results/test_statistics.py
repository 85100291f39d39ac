"""Intervals and paired tests against textbooks."""

import pytest

from rtphys.results.statistics import Paired, Rate, holm, mcnemar, paired, wilson


@pytest.mark.parametrize(
    ("successes", "trials", "low", "high"),
    # Newcombe, Statistics in Medicine 17 (1998) 857-872, table I, method 3.
    [
        (81, 263, 0.2553, 0.3662),
        (15, 148, 0.0624, 0.1605),
        (0, 20, 0.0, 0.1611),
        (1, 29, 0.0061, 0.1718),
    ],
)
def test_the_interval_is_newcombes(successes: int, trials: int, low: float, high: float) -> None:
    assert wilson(successes, trials) == pytest.approx((low, high), abs=5e-5)


@pytest.mark.parametrize("trials", [1, 2, 10, 100])
def test_the_interval_holds_what_was_seen(trials: int) -> None:
    for successes in range(trials + 1):
        low, high = wilson(successes, trials)
        assert 0 <= low <= successes / trials <= high <= 1
    assert Rate(0, 0).value is None and wilson(0, 0) == (0.0, 1.0)


def test_mcnemar_counts_coin_flips() -> None:
    assert mcnemar(1, 9) == pytest.approx(2 * (1 + 10) / 2**10)
    assert mcnemar(9, 1) == mcnemar(1, 9)
    assert mcnemar(0, 0) == mcnemar(3, 3) == 1.0


def test_pairs_are_counted() -> None:
    pairs = [(True, True)] * 5 + [(True, False)] * 3 + [(False, True)] + [(False, False)]
    assert paired(pairs) == Paired(5, 3, 1, 1)
    assert paired(pairs).difference == pytest.approx(-0.2)
    assert paired([]).difference is None and paired([]).to_json()["p"] is None


def test_p_values_are_adjusted_for_how_many_there_are() -> None:
    assert holm([0.01, 0.04, 0.03]) == pytest.approx([0.03, 0.06, 0.06])
    assert holm([0.5, 0.9]) == [1.0, 1.0] and holm([]) == []


def test_json_holds_counts_rate_and_bounds() -> None:
    low, high = wilson(1, 3)
    expected = {"successes": 1, "trials": 3, "rate": 1 / 3, "low": low, "high": high}
    assert Rate(1, 3).to_json() == expected
    assert paired([(True, False)]).to_json()["difference"] == -1.0
