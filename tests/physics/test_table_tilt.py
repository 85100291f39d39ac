"""Plates slide with g (sin - mu cos), balls roll with 5/7 g sin."""

from math import radians

import pytest

from rtphys.physics.attributes.table_tilt import TableTilt
from rtphys.proofs.table_tilt import PROOF

pytestmark = pytest.mark.sim


@pytest.mark.parametrize("value", PROOF.settings, ids=str)
def test_law(obeys, value):
    obeys(PROOF, value)


@pytest.mark.parametrize("company", PROOF.company, ids=str)
def test_law_in_company(obeys, company):
    obeys(PROOF, PROOF.settings[-1], company)


def test_a_tilt_the_other_way_is_caught(caught, monkeypatch):
    def apply(self, target, value):
        target.table_tilt = -radians(value)

    monkeypatch.setattr(TableTilt, "apply", apply)
    caught(PROOF, 2.0, by="roll of a ball")
