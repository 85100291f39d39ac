"""What must hold for every rigid model of the catalogue; a new one is tested by being there."""

import numpy as np
import pytest
from every_model import NAMES, RIGID, made
from official_sizes import SIZES

from rtphys.assets.asset_model import AssetModel
from rtphys.assets.write import bounds

OPENING = 0.09  # [m] between the open fingers
TOLERANCE = 1e-6  # [m] a micrometre, to which files are rounded


def bodies(name: str, index: int):
    thing = made(name, index)
    return [thing.body] if isinstance(thing, AssetModel) else list(thing.links.values())


every_model = pytest.mark.parametrize(("name", "index"), NAMES, ids=lambda v: str(v))


@every_model
def test_collision_parts_are_convex_and_watertight(name, index):
    for body in bodies(name, index):
        for i, part in enumerate(body.collision):
            assert part.is_closed(), f"part {i} is open"
            assert part.bulge() < TOLERANCE, f"part {i} is not convex"
            assert part.volume > 1e-10, f"part {i} is flat or inside out"
            assert len(part.vertices) <= 255, f"part {i} has more corners than PhysX cooks"


@every_model
def test_visible_parts_are_watertight_and_few(name, index):
    for body in bodies(name, index):
        for i, part in enumerate(body.visual):
            assert part.solid.is_closed(), f"part {i} is open"
            assert part.solid.volume > 0, f"part {i} is inside out"
    triangles = sum(len(p.solid.faces) for body in bodies(name, index) for p in body.visual)
    assert triangles <= 1200


@every_model
def test_collision_follows_what_is_seen(name, index):
    for body in bodies(name, index):
        if not body.collision:
            continue
        seen = bounds(body)
        corners = np.array([part.bounds for part in body.collision])
        solid = np.array([corners[:, 0].min(0), corners[:, 1].max(0)])
        np.testing.assert_allclose(solid, seen, atol=0.004)


@every_model
def test_weight_is_that_of_a_household_thing(name, index):
    for body in bodies(name, index):
        if not body.visual:
            continue
        inertial = body.inertial()
        moments = np.linalg.eigvalsh(inertial.inertia)
        assert 0.002 < inertial.mass < 60
        assert moments[0] > 0
        assert moments[0] + moments[1] > 0.999 * moments[2], "no body has such an inertia"
        low, high = bounds(body)
        assert (inertial.com > low).all() and (inertial.com < high).all()


MEASURED = [pair for pair in NAMES if pair in SIZES]


@pytest.mark.parametrize(("name", "index"), MEASURED, ids=lambda v: str(v))
def test_size_is_the_official_one(name, index):
    official = np.array(SIZES[name, index])
    size = np.ptp(bounds(made(name, index).body), axis=0)
    assert (size <= 1.06 * official + 0.001).all(), (size, official)
    # A round thing's metadata box is a third to a half too wide.
    assert (size >= 0.65 * official).all(), (size, official)
    assert size.max() >= 0.7 * official.max()


def _width_between_fingers(thing: AssetModel, X: np.ndarray) -> float:
    """Extent along the finger axis of what lies between the fingertips [m]."""
    widths = []
    for part in thing.body.collision:
        local = (part.vertices - X[:3, 3]) @ X[:3, :3]
        # Between the fingers: within the pads' 2 cm width and from the tips, 3.6 cm past the
        # point, to 2 cm behind it.
        box = np.array([[-0.010, -0.036, -1], [0.010, 0.020, 1]])
        overlap = (local.max(0) > box[0]).all() and (local.min(0) < box[1]).all()
        if overlap:
            widths.append([local[:, 2].min(), local[:, 2].max()])
    return float(np.ptp(widths)) if widths else 0.0


GRASPED = [(n, i) for n, i in RIGID if made(n, i).contact_points and not n.startswith("050_")]


@pytest.mark.parametrize(("name", "index"), GRASPED, ids=lambda v: str(v))
def test_contact_points_fit_the_gripper(name, index):
    thing = made(name, index)
    # Held by one wall.
    hollow = {"002_bowl", "021_cup", "039_mug", "062_plasticbox", "063_tabletrashbin"}
    for i, X in enumerate(thing.contact_points):
        np.testing.assert_allclose(X[:3, :3] @ X[:3, :3].T, np.eye(3), atol=1e-9)
        assert np.linalg.det(X[:3, :3]) > 0.99
        if name not in hollow:
            assert _width_between_fingers(thing, X) <= OPENING, f"contact point {i}"


@every_model
def test_words_for_language(name, index):
    thing = made(name, index)
    assert len(thing.description) >= 3 and len(set(thing.description)) == len(thing.description)
    assert all(not phrase.startswith(("the ", "a ", "an ")) for phrase in thing.description)
    assert thing.categories
