"""Intervals, tests and curves against textbooks and scipy."""

import numpy as np
import pytest
from scipy import stats

from rtphys.results.breaks import breaks
from rtphys.results.logistic import bins, fit
from rtphys.results.record import EpisodeRecord
from rtphys.results.statistics import Paired, Rate, holm, mcnemar, paired, wilson

# Hours of study and whether the exam was passed: the worked example of Wikipedia's article on
# logistic regression, which gives slope 1.5046 (standard error 0.6287) and intercept -4.0777.
HOURS = [0.5, 0.75, 1, 1.25, 1.5, 1.75, 1.75, 2, 2.25, 2.5]
HOURS += [2.75, 3, 3.25, 3.5, 4, 4.25, 4.5, 4.75, 5, 5.5]
PASSED = [bool(x) for x in [0, 0, 0, 0, 0, 0, 1, 0, 1, 0, 1, 0, 1, 0, 1, 1, 1, 1, 1, 1]]


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
def test_the_interval_is_scipys_and_holds_what_was_seen(trials: int) -> None:
    for successes in range(trials + 1):
        low, high = wilson(successes, trials)
        known = stats.binomtest(successes, trials).proportion_ci(method="wilson")
        assert (low, high) == pytest.approx((known.low, known.high), abs=1e-9)
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
    assert paired([]).difference is None


def test_p_values_are_adjusted_for_how_many_there_are() -> None:
    assert holm([0.01, 0.04, 0.03]) == pytest.approx([0.03, 0.06, 0.06])
    assert holm([0.5, 0.9]) == [1.0, 1.0] and holm([]) == []


def test_the_curve_is_the_textbooks() -> None:
    curve = fit(HOURS, PASSED, prior=False)
    assert curve is not None
    span = curve.high - curve.low
    assert curve.slope / span == pytest.approx(1.5046, abs=1e-4)
    assert curve.error / span == pytest.approx(0.6287, abs=1e-4)
    assert curve.levels[0] - curve.slope / span * curve.low == pytest.approx(-4.0777, abs=1e-4)
    assert curve.at(np.array([2.0]))[0] == pytest.approx(0.2557, abs=1e-4)  # of the same table


def test_two_values_give_the_log_odds_ratio_and_the_g_test() -> None:
    table = np.array([[20, 10], [10, 25]])  # x = 0 and 1: successes, failures
    x = [0.0] * 30 + [1.0] * 35
    success = [True] * 20 + [False] * 10 + [True] * 10 + [False] * 25
    curve = fit(x, success, prior=False)
    assert curve is not None
    assert curve.slope == pytest.approx(np.log((10 / 25) / (20 / 10)), abs=1e-6)
    assert curve.error == pytest.approx(np.sqrt((1 / table).sum()), abs=1e-6)
    _, p, *_ = stats.chi2_contingency(table, correction=False, lambda_="log-likelihood")
    assert curve.p == pytest.approx(p, rel=1e-6)


def test_a_perfect_separation_stays_finite() -> None:
    curve = fit(np.arange(20.0).tolist(), [i > 9 for i in range(20)])
    assert curve is not None and 5 < curve.slope < 60 and curve.p < 1e-3


def test_easy_tasks_with_other_values_feign_no_slope() -> None:
    rng = np.random.default_rng(1)
    task = np.repeat([0, 1], 200)
    x = np.where(task == 0, rng.uniform(0, 0.6, 400), rng.uniform(0.4, 1, 400))
    success = rng.random(400) < np.where(task == 0, 0.1, 0.9)
    blind, fair = (
        fit(x.tolist(), success.tolist()),
        fit(x.tolist(), success.tolist(), task.tolist()),
    )
    assert blind is not None and fair is not None
    assert blind.p < 1e-6 and fair.p > 0.01


def test_nothing_is_fitted_where_nothing_varies() -> None:
    assert fit([1.0, 1.0], [True, False]) is None
    assert fit([1.0, 2.0], [True, True]) is None
    assert fit([], []) is None


def test_bins_hold_every_episode_once() -> None:
    x = [0.0, 0.1, 0.5, 0.99, 1.0]
    found = bins(x, [True, False, True, True, True])
    assert sum(rate.trials for _, _, rate in found) == 5
    assert [(round(a, 1), rate) for a, _, rate in found] == [
        (0.0, Rate(1, 2)),
        (0.4, Rate(1, 1)),
        (0.8, Rate(2, 2)),
    ]


def test_the_attribute_that_breaks_a_policy_comes_first() -> None:
    rng = np.random.default_rng(0)
    records = []
    for seed in range(120):
        friction, com = rng.uniform(0.01, 1.25), rng.uniform(-0.015, 0.015, 3)
        physics = {"friction": friction, "center_of_mass": com.tolist(), "object_mass": None}
        win = bool(rng.random() < (0.95 if friction > 0.6 else 0.1))
        records.append(EpisodeRecord("stack", "phys_random", seed, win, physics=physics))
    first, *rest = breaks(records)
    assert first.key == "friction" and first.curve.slope > 3 and first.p_holm < 1e-6
    assert [one.key for one in rest] == ["center_of_mass"] and rest[0].p_holm > 0.01


def test_attributes_that_share_a_draw_are_one() -> None:
    records = [
        EpisodeRecord("stack", "phys_random", seed, seed % 3 == 0, physics=shared)
        for seed in range(30)
        if (shared := {"arm_joint_damping": seed / 9, "gripper_joint_damping": seed / 9})
    ]
    (one,) = breaks(records)
    assert (one.key, one.same) == ("arm_joint_damping", ("gripper_joint_damping",))
    assert one.p_holm == one.curve.p
