"""Profiles, lofts and lying rods: closed, convex where they say so, on a facet; letters as dots."""

import numpy as np
import pytest

from rtphys.assets.lettering import dots, write
from rtphys.assets.swept import bevelled, dome, loft, lying, oval, rod, side_profile, slabs

L_SHAPE = [(0, 0), (2, 0), (2, 1), (1, 1), (1, 2), (0, 2)]


def test_side_profile_keeps_area_times_width_and_faces_outward():
    solid = side_profile(L_SHAPE, 0.5)
    assert solid.is_closed()
    assert solid.volume == pytest.approx(3 * 0.5)
    np.testing.assert_allclose(solid.bounds, [[-0.25, 0, 0], [0.25, 2, 2]])


def test_bevelled_is_convex_within_its_outline_and_loses_only_edges():
    solid = bevelled([(0, 0), (0.1, 0), (0.1, 0.04), (0, 0.04)], 0.03, 0.004)
    assert solid.is_closed() and solid.bulge() < 1e-9
    np.testing.assert_allclose(solid.extents, [0.03, 0.04, 0.1])
    assert 0.8 * 0.1 * 0.04 * 0.03 < solid.volume < 0.1 * 0.04 * 0.03


def test_loft_of_equal_rings_is_a_prism_and_slabs_fill_it():
    rings = np.array([oval(0.04, 0.02, z, 12, 3) for z in (0.0, 0.03, 0.05)])
    solid, parts = loft(rings), slabs(rings, (0, 1, 2))
    assert solid.is_closed() and solid.bulge() < 1e-9
    assert sum(p.volume for p in parts) == pytest.approx(solid.volume)


def test_loft_faces_outward_whichever_way_the_rings_run():
    rings = [dome(0.04, 0.02, z) for z in (0.05, 0.0)]
    assert loft(rings).volume > 0 and loft(rings[::-1]).volume > 0


@pytest.mark.parametrize("sides", [6, 8, 10, 12, 16])
def test_what_lies_rests_on_a_facet_at_the_ground(sides):
    low = rod(0.01, -0.05, 0.05, sides).vertices
    resting = low[low[:, 1] < 1e-9]
    assert np.abs(resting[:, 1]).max() < 1e-9
    assert np.ptp(resting[:, 0]) > 0.003, "a corner is underneath, not a facet"


def test_lying_on_its_handle_leaves_the_thin_end_in_the_air():
    tool = lying([(0, 0), (0.01, 0), (0.01, 0.05), (0.004, 0.05), (0.004, 0.1), (0, 0.1)], 12)
    thin = tool.vertices[tool.vertices[:, 2] > 0.06]
    assert thin[:, 1].min() > 0.004


def test_letters_are_three_by_five_and_too_long_a_word_is_refused():
    pattern = dots("TEA")
    assert pattern.shape == (5, 11)
    assert pattern[0, :3].all() and not pattern[1, 0]  # the T's bar
    canvas = np.zeros((7, 11, 3))
    assert write(canvas, "TEA", 1, (1, 1, 1)).any(axis=2).sum() == pattern.sum()
    with pytest.raises(ValueError, match="too large"):
        write(np.zeros((7, 10, 3)), "TEA", 1, (1, 1, 1))
    with pytest.raises(KeyError):
        dots("É")
