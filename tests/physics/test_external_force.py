"""A push of c m g along +X, in the policy stage alone."""

import pytest

from rtphys.physics.attributes.external_force import ExternalForce
from rtphys.proofs.external_force import PROOF

pytestmark = pytest.mark.sim


@pytest.mark.parametrize("value", PROOF.settings, ids=str)
def test_law(obeys, value):
    obeys(PROOF, value)


@pytest.mark.parametrize("company", PROOF.company, ids=str)
def test_law_in_company(obeys, company):
    obeys(PROOF, PROOF.settings[-1], company)


def test_a_force_of_twice_the_label_is_caught(caught, monkeypatch):
    def apply(self, target, value):
        target.external_force = 2 * value

    monkeypatch.setattr(ExternalForce, "apply", apply)
    caught(PROOF, 0.1, by="a in the air")
