"""The table: common features alone, gaps filled without a look at labels."""

import numpy as np

from rtphys.identification.table import Sample, table_of


def sample(seed: int, **features: float) -> Sample:
    labels = {"friction": float(seed)} if seed % 2 else {}
    return Sample(seed, {f"lift/hand/effort/{k}/mean": v for k, v in features.items()}, labels)


def test_rare_and_constant_features_are_left_out_and_gaps_are_medians() -> None:
    table = table_of(
        [
            sample(3, a=4.0, same=1.0),
            sample(1, a=1.0, same=1.0, rare=5.0),
            sample(2, same=1.0),
            sample(0, a=2.0, same=1.0),
        ]
    )
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
