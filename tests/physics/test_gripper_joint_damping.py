"""Fingers lag by tau = k d / stiffness."""

import pytest

from rtphys.physics.attributes.gripper_joint_damping import GripperJointDamping
from rtphys.proofs.gripper_joint_damping import PROOF

pytestmark = pytest.mark.sim


@pytest.mark.parametrize("value", PROOF.settings, ids=str)
def test_law(obeys, value):
    obeys(PROOF, value)


@pytest.mark.parametrize("company", PROOF.company, ids=str)
def test_law_in_company(obeys, company):
    obeys(PROOF, PROOF.settings[-1], company)


def test_a_factor_as_an_absolute_gain_is_caught(caught, monkeypatch):
    def apply(self, target, value):
        for servo in target.gripper_servos:
            servo.set_damping(value)

    monkeypatch.setattr(GripperJointDamping, "apply", apply)
    caught(PROOF, 3.0, by="fingers")
