"""A ball comes back to e² h."""

import pytest

from rtphys.physics.attributes.restitution import Restitution
from rtphys.proofs.restitution import PROOF

pytestmark = pytest.mark.sim


@pytest.mark.parametrize("value", PROOF.settings, ids=str)
def test_law(obeys, value):
    obeys(PROOF, value)


@pytest.mark.parametrize("company", PROOF.company, ids=str)
def test_law_in_company(obeys, company):
    obeys(PROOF, PROOF.settings[-1], company)


def test_a_restitution_of_the_object_alone_is_caught(caught, monkeypatch):
    def apply(self, target, value):
        for surface in target.surfaces[:1]:
            surface.set_material(0.5, 0.5, value)

    monkeypatch.setattr(Restitution, "apply", apply)
    caught(PROOF, 0.5, by="bounce height")
