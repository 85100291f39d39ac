"""A centre of mass must lie inside the body, one tenth below its surface."""

import numpy as np
import pytest

from rtphys.physics import load_domain
from rtphys.physics.hull import Solid, centroid, inside
from rtphys.physics.reach import Reach

CORNERS = np.array([[x, y, z] for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)], float)


def box(half):
    return Solid(CORNERS * half, np.zeros(3))


def test_a_box_holds_nine_tenths_of_its_half_size():
    solid = box([0.02, 0.03, 0.04])
    for axis, half in enumerate([0.02, 0.03, 0.04]):
        for sign in (-1, 1):
            offset = np.zeros(3)
            offset[axis] = sign * 0.9 * half
            assert solid.holds(0.999 * offset)
            assert not solid.holds(1.001 * offset)


def test_the_offset_counts_from_the_bodys_own_centre():
    solid = Solid(CORNERS * 0.02, np.array([0.01, 0, 0]))
    assert solid.holds([0.0079, 0, 0])
    assert not solid.holds([0.0081, 0, 0])
    assert solid.holds([-0.0279, 0, 0])


def test_scale_grows_the_body_not_the_offset():
    solid = box([0.01, 0.05, 0.05])
    assert not solid.holds([0.0095, 0, 0])
    assert solid.holds([0.0095, 0, 0], scale=1.1)
    assert not inside({"a": solid, "b": box([0.009] * 3)}, scale=1.05)((0.0088, 0.0, 0.0), Reach())


def test_centroid_is_that_of_the_volume_not_of_the_vertices():
    # A tetrahedron with extra points crowded near one corner.
    tetra = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1.0]])
    crowd = 0.01 * np.random.default_rng(0).random((50, 3))
    assert np.allclose(centroid(np.vstack([tetra, crowd])), 0.25, atol=1e-6)


def test_a_pack_of_cards_truncates_the_draw_and_keeps_the_label_exact():
    cards = box([0.044, 0.031, 0.01])
    fits = inside({"cards": cards})
    domain, redrawn = load_domain("global"), 0
    for seed in range(200):
        physics = domain.sample(seed, inside=fits)
        assert abs(physics.vector("center_of_mass")[2]) <= 0.009
        redrawn += physics["center_of_mass_redraws"] > 0
    assert 0.25 < redrawn / 200 < 0.55  # 40 % of ±15 mm lies outside ±9 mm


def test_a_flat_body_is_an_error_not_a_wrong_answer():
    with pytest.raises(Exception, match=r"flat|QH"):
        Solid(CORNERS[:4] * [0, 1, 1], np.zeros(3)).holds([0, 0, 0])
