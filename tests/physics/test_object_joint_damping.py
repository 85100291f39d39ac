"""A door that is pushed once slows as exp(-d t / I)."""

import pytest

from rtphys.physics.attributes.object_joint_damping import ObjectJointDamping
from rtphys.proofs.object_joint_damping import PROOF

pytestmark = pytest.mark.sim


@pytest.mark.parametrize("value", PROOF.settings, ids=str)
def test_law(obeys, value):
    obeys(PROOF, value)


@pytest.mark.parametrize("company", PROOF.company, ids=str)
def test_law_in_company(obeys, company):
    obeys(PROOF, PROOF.settings[-1], company)


def test_a_damping_that_is_never_written_is_caught(caught, monkeypatch):
    def apply(self, target, value):
        for joint in target.joints:
            joint.set_friction(0.0)

    monkeypatch.setattr(ObjectJointDamping, "apply", apply)
    caught(PROOF, 25.0, by="coasting")
