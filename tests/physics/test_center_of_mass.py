"""An off-centre push spins a body; a bar tips past its balance point."""

import pytest

from rtphys.physics.attributes.center_of_mass import CenterOfMass
from rtphys.proofs.center_of_mass import PROOF

pytestmark = pytest.mark.sim


@pytest.mark.parametrize("value", PROOF.settings, ids=str)
def test_law(obeys, value):
    obeys(PROOF, value)


@pytest.mark.parametrize("company", PROOF.company, ids=str)
def test_law_in_company(obeys, company):
    obeys(PROOF, PROOF.settings[-1], company)


def test_a_mirrored_offset_is_caught(caught, monkeypatch):
    def apply(self, target, value):
        for body in target.bodies:
            body.set_com(body.nominal_com - value)

    monkeypatch.setattr(CenterOfMass, "apply", apply)
    caught(PROOF, (0.015, 0.015, 0.015), by="balance point")
