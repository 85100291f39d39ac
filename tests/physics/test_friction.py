"""Stopping way, breakaway push, and the slip of a gripped block."""

import pytest

from rtphys.physics.attributes.friction import Friction
from rtphys.proofs.friction import PROOF

pytestmark = pytest.mark.sim


@pytest.mark.parametrize("value", PROOF.settings, ids=str)
def test_law(obeys, value):
    obeys(PROOF, value)


@pytest.mark.parametrize("company", PROOF.company, ids=str)
def test_law_in_company(obeys, company):
    obeys(PROOF, PROOF.settings[-1], company)


def test_a_friction_of_the_object_alone_is_caught(caught, monkeypatch):
    def apply(self, target, value):
        # PhysX averages the two surfaces: the object's own number is not the pair's.
        for surface in target.surfaces[:1]:
            surface.set_material(value, value, 0.0)

    monkeypatch.setattr(Friction, "apply", apply)
    caught(PROOF, 0.01, by="stopping way")


def test_a_friction_that_forgets_the_fingers_is_caught(caught, monkeypatch):
    def apply(self, target, value):
        for surface in target.surfaces:
            if "gripper" not in surface.name:
                surface.set_material(value, value, 0.0)

    monkeypatch.setattr(Friction, "apply", apply)
    caught(PROOF, 1.25, by="between finger and object")
