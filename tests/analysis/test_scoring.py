"""Scores: 1 where the features tell all, about 0 where they tell nothing, whoever estimates."""

from dataclasses import replace

import numpy as np
import pytest

from rtphys.analysis.estimators import Trees
from rtphys.analysis.scoring import MIN_BEYOND, NotFinite, Sample, score, table_of
from rtphys.core.poses import Array
from rtphys.core.seeds import stream


def samples(count: int, useful: float = 1.0) -> list[Sample]:
    """Episodes whose effort tells `friction` (0 to 1) and both components of a vector.

    Args:
        useful: 1: exactly; 0: not at all.
    """
    rng = stream(0, "test identification")
    found: list[Sample] = []
    for seed in range(count):
        value, x, y = rng.uniform(size=3)
        noise = rng.uniform(size=3)
        sensed = useful * np.array([value, x, y]) + (1 - useful) * noise
        features = {
            "lift/hand/effort/force_x/mean": sensed[0] + sensed[1],
            "lift/hand/effort/force_y/mean": sensed[1],
            "lift/hand/effort/force_z/mean": sensed[2],
            "lift/hand/touch/touch/mean": float(rng.uniform()),
            "lift/duration": float(rng.uniform()),
        }
        labels = {"friction": float(value), "center_of_mass": (float(x), float(y))}
        found.append(Sample(seed, {k: float(v) for k, v in features.items()}, labels))
    return found


class Line:
    """Least squares with a constant: an estimator without chance."""

    def fit(self, X: Array, y: Array) -> None:
        self.weights = np.linalg.lstsq(np.column_stack([X, np.ones(len(X))]), y, rcond=None)[0]

    def predict(self, X: Array) -> Array:
        return np.column_stack([X, np.ones(len(X))]) @ self.weights


UNIT = (0.0, 1.0)


def test_what_the_features_hold_is_found_also_beyond_the_range_learnt_from() -> None:
    found = score(table_of(samples(80)), "friction", UNIT, Line)
    assert found.interval[0] <= found.r2 <= found.interval[1] and found.r2 > 0.999
    assert found.beyond is not None and found.beyond.r2 > 0.999
    assert found.beyond.n < found.n == 80
    assert found.shuffled <= 0.02
    assert found.importance["effort"] > 0.5
    assert max(abs(found.importance[group]) for group in ("touch", "timing")) < 0.05


def test_useless_features_score_nothing() -> None:
    useless = score(table_of(samples(80, useful=0)), "friction", UNIT, Line)
    assert useless.r2 <= 0.02 and useless.interval[0] < 0.02


def test_components_of_a_vector_are_averaged() -> None:
    table = table_of(samples(80))
    whole = score(table, "center_of_mass", UNIT, Line)
    assert whole.r2 > 0.999
    _, Y = table.labelled("center_of_mass")
    assert Y.shape == (80, 2)
    blind = list(table.samples)
    for s in blind:
        s.features["lift/hand/effort/force_y/mean"] = 0.0  # type: ignore[index]
        s.features["lift/hand/effort/force_x/mean"] = 0.0  # type: ignore[index]
    half = score(table_of(blind), "center_of_mass", UNIT, Line)
    assert 0.3 < half.r2 < 0.6  # one component is read, the other is not


def test_few_episodes_on_one_side_give_no_score_beyond() -> None:
    few = [s for s in samples(200) if 0.25 <= s.labels["friction"] <= 0.75]  # type: ignore[operator]
    assert score(table_of(few), "friction", UNIT, Line).beyond is None
    assert len(few) > MIN_BEYOND


def test_a_rare_value_leaves_all_numbers_finite() -> None:
    """Some draws of the bootstrap lack it: without variance there is no R2."""
    rare = [replace(s, labels={"friction": float(s.seed == 7)}) for s in samples(24)]
    assert np.isfinite(score(table_of(rare), "friction", UNIT, Line).interval).all()
    half = [replace(s, labels={"friction": 0.5 * (s.seed % 2)}) for s in samples(24)]
    assert score(table_of(half), "friction", UNIT, Line).beyond is None, "all outside are equal"


@pytest.mark.parametrize(
    ("said", "problem"),
    [
        ([np.nan], "not finite"),
        ([np.inf], "not finite"),
        ([1e200], "has no R2"),
        ([0, 0], "shape"),
    ],
)
def test_what_is_no_finite_number_an_episode_is_named(
    said: list[float], problem: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(Line, "predict", lambda _, X: np.squeeze([said] * len(X)))
    with pytest.raises(NotFinite, match=problem):
        score(table_of(samples(30)), "friction", UNIT, Line)


def test_trees_learn_and_are_the_same_every_time() -> None:
    pytest.importorskip("sklearn")
    first, second = (score(table_of(samples(60)), "friction", UNIT, Trees) for _ in range(2))
    assert first == second
    assert first.r2 > 0.5
    assert first.shuffled <= 0.02


def sample(seed: int, **features: float) -> Sample:
    labels = {"friction": float(seed)} if seed % 2 else {}
    return Sample(seed, {f"lift/hand/effort/{k}/mean": v for k, v in features.items()}, labels)


def test_rare_and_constant_features_are_left_out_and_gaps_are_medians() -> None:
    few = (3, {"a": 4.0}), (1, {"a": 1.0, "rare": 5.0}), (2, {}), (0, {"a": 2.0})
    table = table_of([sample(seed, same=1.0, **features) for seed, features in few])
    assert table.names == ("lift/hand/effort/a/mean",)
    assert table.values.ravel().tolist() == [2.0, 1.0, 2.0, 4.0]  # by seed
    assert {group: columns.tolist() for group, columns in table.groups.items()} == {"effort": [0]}


def test_only_episodes_in_which_an_attribute_acts_are_labelled() -> None:
    table = table_of([sample(seed, a=float(seed)) for seed in range(4)])
    X, Y = table.labelled("friction")
    np.testing.assert_array_equal(X, [[1], [3]])
    np.testing.assert_array_equal(Y, [[1], [3]])


def test_of_features_of_a_group_that_say_the_same_the_first_remains() -> None:
    rng = np.random.default_rng(0)
    rows = []
    for seed in range(50):
        first, other = rng.normal(size=2)
        features = {
            "lift/hand/effort/a/mean": first,
            "lift/hand/effort/b/mean": 3 - 2 * first + 0.01 * other,
            "lift/hand/effort/c/mean": first + other,
            "lift/hand/joints/a/mean": first,  # another group's
        }
        rows.append(Sample(seed, features, {}))
    assert table_of(rows).names == (
        "lift/hand/effort/a/mean",
        "lift/hand/effort/c/mean",
        "lift/hand/joints/a/mean",
    )


def test_no_samples_make_an_empty_table() -> None:
    assert table_of([]).values.shape == (0, 0)
