"""Length, mass and inertia grow with k, k³ and k⁵."""

import pytest

from rtphys.physics.attributes.object_scale import ObjectScale
from rtphys.proofs.object_scale import PROOF

pytestmark = pytest.mark.sim


@pytest.mark.parametrize("value", PROOF.settings, ids=str)
def test_law(obeys, value):
    obeys(PROOF, value)


@pytest.mark.parametrize("company", PROOF.company, ids=str)
def test_law_in_company(obeys, company):
    obeys(PROOF, PROOF.settings[-1], company)


def test_a_scale_that_nobody_uses_is_caught(caught, monkeypatch):
    def apply(self, target, value):
        target.object_scale = 1.0

    monkeypatch.setattr(ObjectScale, "apply", apply)
    caught(PROOF, 0.85, by="inertia ratio")
