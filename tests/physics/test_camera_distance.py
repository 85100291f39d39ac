"""An orbit keeps range and gaze, a shift the orientation."""

import pytest

from rtphys.physics import gaze
from rtphys.physics.attributes.camera_distance import CameraDistance
from rtphys.proofs.camera_distance import PROOF

pytestmark = pytest.mark.sim


@pytest.mark.parametrize("value", PROOF.settings, ids=str)
def test_law(obeys, value):
    obeys(PROOF, value)


@pytest.mark.parametrize("company", PROOF.company, ids=str)
def test_law_in_company(obeys, company):
    obeys(PROOF, PROOF.settings[-1], company)


def test_an_orbit_that_does_not_look_back_is_caught(caught, monkeypatch):
    def apply(self, target, value):
        gaze.move(target.head_camera, "shift", self.direction, value)

    monkeypatch.setattr(CameraDistance, "apply", apply)
    caught(PROOF, 0.1, by="gaze pixel, orbit")
