"""Which attributes break a policy, and the logistic curves that say so."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest
from scipy import stats

from rtphys.results import breaks as module
from rtphys.results.breaks import MIN_EPISODES, bins, breaks, fit, without_evidence
from rtphys.results.evaluation import EpisodeRecord
from rtphys.results.statistics import Rate


def records(count: int, physics: Callable[[int], dict[str, object]]) -> list[EpisodeRecord]:
    """Every third succeeds."""
    return [
        EpisodeRecord("stack", "phys_random", seed, seed % 3 == 0, physics=physics(seed))
        for seed in range(count)
    ]


def test_the_attribute_that_breaks_a_policy_comes_first() -> None:
    rng = np.random.default_rng(0)
    played = []
    for seed in range(120):
        friction, com = rng.uniform(0.01, 1.25), rng.uniform(-0.015, 0.015, 3)
        physics = {"friction": friction, "center_of_mass": com.tolist(), "object_mass": None}
        win = bool(rng.random() < (0.95 if friction > 0.6 else 0.1))
        played.append(EpisodeRecord("stack", "phys_random", seed, win, physics=physics))
    first, *rest = breaks(played)
    assert first.key == "friction" and first.curve.slope > 3 and first.p_holm < 1e-6
    assert [one.key for one in rest] == ["center_of_mass"] and rest[0].p_holm > 0.01
    found = {"phys_random": [first, *rest], "only_friction": [], "clean": rest}
    (line,) = without_evidence(found)
    assert line.startswith("clean: no attribute has a significant effect")


def test_attributes_that_share_a_draw_are_one() -> None:
    keys = ("arm_joint_damping", "gripper_joint_damping")
    (one,) = breaks(records(30, lambda seed: dict.fromkeys(keys, seed / 9)))
    assert (one.key, one.same) == ("arm_joint_damping", ("gripper_joint_damping",))
    assert one.p_holm == one.curve.p


def test_few_episodes_give_no_curve() -> None:
    few = records(MIN_EPISODES, lambda seed: {"friction": seed / 9})
    assert [effect.key for effect in breaks(few)] == ["friction"]
    assert breaks(few[1:]) == []


def test_json_names_the_attribute_and_its_bins() -> None:
    (effect,) = breaks(records(11, lambda seed: {"friction": seed / 10}))
    data = effect.to_json()
    assert (data["attribute"], data["low"], data["high"]) == ("friction", 0.0, 1.0)
    assert data["log_odds"] == effect.curve.slope != 0
    assert isinstance(data["bins"], list)
    assert sum(part["trials"] for part in data["bins"]) == 11


def test_an_attribute_that_does_not_act_is_no_factor() -> None:
    played = records(30, lambda seed: {"friction": seed / 9, "object_mass": 4 - seed / 9})
    (one,) = breaks([replace(record, inert=("object_mass",)) for record in played])
    assert (one.key, one.same) == ("friction", ())
    both = breaks([replace(r, inert=("object_mass",) * (r.seed % 2)) for r in played])
    trials = {effect.key: sum(rate.trials for *_, rate in effect.bins) for effect in both}
    assert trials == {"friction": 30, "object_mass": 15}


def test_tasks_in_which_an_attribute_does_not_act_do_not_move_its_curve() -> None:
    """The figure drew each of them at 50 %."""
    played = records(30, lambda seed: {"friction": seed / 9})
    others = [replace(record, task=task, inert=("friction",)) for record in played for task in "az"]
    (alone,), (among,) = breaks(played), breaks([*others, *played])
    assert among.curve == alone.curve


# Hours of study and whether the exam was passed: the worked example of Wikipedia's article on
# logistic regression, which gives slope 1.5046 (standard error 0.6287) and intercept -4.0777.
HOURS = [0.5, 0.75, 1, 1.25, 1.5, 1.75, 1.75, 2, 2.25, 2.5]
HOURS += [2.75, 3, 3.25, 3.5, 4, 4.25, 4.5, 4.75, 5, 5.5]
PASSED = [bool(x) for x in [0, 0, 0, 0, 0, 0, 1, 0, 1, 0, 1, 0, 1, 0, 1, 1, 1, 1, 1, 1]]


@pytest.fixture
def flat(monkeypatch: pytest.MonkeyPatch) -> None:
    """Priors so wide that the fit is that of textbooks, by maximum likelihood."""
    monkeypatch.setattr(module, "SLOPE_SPREAD", 1e6)
    monkeypatch.setattr(module, "LEVEL_SPREAD", 1e6)


@pytest.mark.usefixtures("flat")
def test_the_curve_is_the_textbooks() -> None:
    curve = fit(HOURS, PASSED)
    assert curve is not None
    span = curve.high - curve.low
    assert curve.slope / span == pytest.approx(1.5046, abs=1e-4)
    assert curve.error / span == pytest.approx(0.6287, abs=1e-4)
    assert curve.levels[0] - curve.slope / span * curve.low == pytest.approx(-4.0777, abs=1e-4)
    assert curve.at(np.array([2.0]))[0] == pytest.approx(0.2557, abs=1e-4)  # of the same table


@pytest.mark.usefixtures("flat")
def test_two_values_give_the_log_odds_ratio_and_the_g_test() -> None:
    table = np.array([[20, 10], [10, 25]])  # x = 0 and 1: successes, failures
    x = [0.0] * 30 + [1.0] * 35
    success = [True] * 20 + [False] * 10 + [True] * 10 + [False] * 25
    curve = fit(x, success)
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
    data = x.tolist(), success.tolist()
    blind, fair = fit(*data), fit(*data, task.tolist())
    assert blind is not None and fair is not None
    assert blind.p < 1e-6 and fair.p > 0.01


def test_nothing_is_fitted_where_nothing_varies() -> None:
    assert fit([1.0, 1.0], [True, False]) is None
    assert fit([1.0, 2.0], [True, True]) is None
    nearly = 0.1 + 0.2, 0.3  # lengths of vectors of one length, in which only rounding differs
    assert fit(nearly, [True, False]) is None
    assert breaks(records(16, lambda seed: {"friction": nearly[seed % 2]})) == []
    assert fit([], []) is None


def test_bins_hold_every_episode_once() -> None:
    x = [0.0, 0.1, 0.5, 0.99, 1.0]
    found = bins(x, [True, False, True, True, True])
    rates = {round(low, 1): rate for low, _, rate in found}
    assert rates == {0.0: Rate(1, 2), 0.4: Rate(1, 1), 0.8: Rate(2, 2)}
