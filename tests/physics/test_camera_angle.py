"""Pan and tilt move the gaze by f tan(theta), a roll turns the horizon."""

import pytest

from rtphys.physics import gaze
from rtphys.physics.attributes.camera_angle import CameraAngle
from rtphys.proofs.camera_angle import PROOF

pytestmark = pytest.mark.sim


@pytest.mark.parametrize("value", PROOF.settings, ids=str)
def test_law(obeys, value):
    obeys(PROOF, value)


@pytest.mark.parametrize("company", PROOF.company, ids=str)
def test_law_in_company(obeys, company):
    obeys(PROOF, PROOF.settings[-1], company)


def test_an_angle_in_the_wrong_unit_is_caught(caught, monkeypatch):
    def apply(self, target, value):
        gaze.turn_by(target.head_camera, self.mode, self.direction, value / 100)

    monkeypatch.setattr(CameraAngle, "apply", apply)
    caught(PROOF, 10.0, by="gaze pixel, pan")
