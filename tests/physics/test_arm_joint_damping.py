"""Arm servos lag by tau = k d / stiffness."""

import pytest

from rtphys.physics.attributes.arm_joint_damping import ArmJointDamping
from rtphys.proofs.arm_joint_damping import PROOF

pytestmark = pytest.mark.sim


@pytest.mark.parametrize("value", PROOF.settings, ids=str)
def test_law(obeys, value):
    obeys(PROOF, value)


@pytest.mark.parametrize("company", PROOF.company, ids=str)
def test_law_in_company(obeys, company):
    obeys(PROOF, PROOF.settings[-1], company)


def test_a_factor_on_one_arm_only_is_caught(caught, monkeypatch):
    def apply(self, target, value):
        for servo in target.arm_servos[:6]:
            servo.set_damping(servo.nominal_damping * value)

    monkeypatch.setattr(ArmJointDamping, "apply", apply)
    caught(PROOF, 3.0, by="right joint")
