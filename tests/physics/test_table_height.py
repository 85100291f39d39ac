"""Dropped bodies come to rest where the table is."""

import pytest

from rtphys.physics.attributes.table_height import TableHeight
from rtphys.proofs.table_height import PROOF

pytestmark = pytest.mark.sim


@pytest.mark.parametrize("value", PROOF.settings, ids=str)
def test_law(obeys, value):
    obeys(PROOF, value)


@pytest.mark.parametrize("company", PROOF.company, ids=str)
def test_law_in_company(obeys, company):
    obeys(PROOF, PROOF.settings[-1], company)


def test_a_height_in_centimetres_is_caught(caught, monkeypatch):
    def apply(self, target, value):
        target.table_height = value / 100

    monkeypatch.setattr(TableHeight, "apply", apply)
    caught(PROOF, -0.08, by="contact height")
