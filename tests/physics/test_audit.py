"""An audit finds labels that lie, and says in words where feasibility cut."""

import numpy as np
import pytest

from rtphys.proofs.audit_labels import differences
from rtphys.proofs.audit_selection import Selection, selections

N = 400
MU = np.random.default_rng(1).uniform(0.01, 1.25, N)
MASS = np.random.default_rng(2).uniform(0.125, 4, N)


def attempts(accepted):
    return [
        ({"friction": mu, "object_mass": m, "center_of_mass": [0.01 * m, 0.0, 0.0]}, kept)
        for mu, m, kept in zip(MU.tolist(), MASS.tolist(), accepted, strict=True)
    ]


UNITS = {"friction": "1", "object_mass": "×", "center_of_mass": "m"}


def test_a_cut_is_found_where_it_is_and_nowhere_else():
    found = {s.key: s for s in selections(attempts(MU > 0.25), UNITS)}
    assert found.keys() == {"friction", "object_mass", "center_of_mass.x"}  # y, z do not vary
    assert found["friction"].p < 1e-10
    assert found["friction"].sentence.startswith("low values were cut: of 0.0")
    assert found["object_mass"].sentence == "no cut that shows"
    edges, rates = found["friction"].rates
    assert rates[0] < 0.1
    assert np.all(rates[1:] == 1)
    assert abs(edges[1] - 0.258) < 0.05


def test_a_cut_at_the_other_end_and_in_the_middle():
    def sentence(accepted):
        return selections(attempts(accepted), UNITS)[1].sentence

    assert sentence(MU < 1.0).startswith("high values were cut")
    assert sentence(abs(MU - 0.63) > 0.1).startswith("middle values were cut")


def test_blind_acceptance_shows_no_cut():
    kept = np.random.default_rng(3).random(N) < 0.7
    for one in selections(attempts(kept), UNITS):
        assert one.sentence == "no cut that shows"
        assert one.distance < 0.1


def test_few_rejections_and_no_acceptance():
    few = Selection("k", "1", MU, np.arange(N) > 2)
    assert (few.sentence, few.p) == ("too few rejections to tell", 1.0)
    none = Selection("k", "1", MU, np.zeros(N, bool))
    assert (none.sentence, none.distance) == ("nothing was accepted", 1.0)


def test_a_distance_is_that_of_the_textbook():
    # Of uniform values the upper half is kept: the two distributions are 0.5 apart.
    values = np.linspace(0, 1, 1001)
    assert abs(Selection("k", "1", values, values > 0.5).distance - 0.5) < 2e-3


@pytest.mark.parametrize(
    ("stored", "now", "words"),
    [
        ({"a": {"mass": 1.0}}, {"a": {"mass": 1.0 + 1e-8}}, None),
        ({"a": {"mass": 1.0}}, {"a": {"mass": 1.00001}}, "r.a.mass: the label says 1.0"),
        ({"a": {}}, {"a": {}, "b": {"mass": 1.0}}, "r.b: only the rebuilt world has it"),
        ({"a": [1, 2, 3]}, {"a": [1, 2]}, "r.a: the label says [1, 2, 3]"),
        ({"a": "x"}, {"a": "y"}, "r.a: the label says x"),
    ],
)
def test_differences_name_the_place(stored, now, words):
    found = differences("r", stored, now)
    assert (found == []) if words is None else found[0].startswith(words)
