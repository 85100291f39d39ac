"""a = F / (k m) and alpha = tau / (k I)."""

import pytest

from rtphys.physics.attributes.object_mass import ObjectMass
from rtphys.proofs.object_mass import PROOF

pytestmark = pytest.mark.sim


@pytest.mark.parametrize("value", PROOF.settings, ids=str)
def test_law(obeys, value):
    obeys(PROOF, value)


@pytest.mark.parametrize("company", PROOF.company, ids=str)
def test_law_in_company(obeys, company):
    obeys(PROOF, PROOF.settings[-1], company)


def test_a_mass_without_its_inertia_is_caught(caught, monkeypatch):
    def apply(self, target, value):
        for body in target.bodies:
            body.set_mass(body.nominal_mass * value)

    monkeypatch.setattr(ObjectMass, "apply", apply)
    caught(PROOF, 4.0, by="alpha about x")
