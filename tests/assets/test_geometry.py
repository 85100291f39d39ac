"""The kit: closed, outward, of the right volume."""

import numpy as np
import pytest

from rtphys.assets import geometry as g
from rtphys.assets.parts import shell_parts, tray_parts
from rtphys.assets.solid import Solid, hull

SHAPES = {
    "box": (g.box(1, 2, 3), 6.0, True),
    "rounded_box": (g.rounded_box(1, 1, 1, 0.1, 3), 0.97, True),
    "cylinder": (g.cylinder(1, 2, 64), 2 * np.pi, True),
    "cone": (g.cone(1, 0, 3, 64), np.pi, True),
    "ball": (g.ball(1, 48), 4 / 3 * np.pi, True),
    "capsule": (g.capsule(0.5, 3, 48), np.pi * (0.5 + 4 / 3 / 8), True),
    "extrude": (g.extrude([(0, 0), (2, 0), (2, 1), (1, 1), (1, 2), (0, 2)], 0.5), 1.5, False),
    "ring": (g.lathe([(1, 0), (1.2, 0), (1.2, 1), (1, 1)], 64), np.pi * 0.44, False),
    "tube": (g.tube([(0, 0, 0), (0, 1, 0), (1, 1, 0)], 0.1, 32), 0.02 * np.pi, False),
    "boolean": (g.box(1, 1, 1) - g.box(0.5, 2, 0.5), 0.75, False),
}


@pytest.mark.parametrize("name", SHAPES)
def test_shapes_are_closed_and_outward(name):
    solid, volume, convex = SHAPES[name]
    assert solid.is_closed()
    assert solid.volume == pytest.approx(volume, rel=0.02)
    assert (solid.bulge() < 1e-9) is convex


def test_an_open_surface_is_not_closed():
    box = g.box(1, 1, 1)
    assert not Solid(box.vertices, box.faces[1:]).is_closed()


def test_moments_of_a_displaced_box():
    volume, first, second = g.box(2, 3, 4).at(1, 2, 3).moments
    assert volume == pytest.approx(24)
    np.testing.assert_allclose(first / volume, [1, 2, 3])
    about = second - volume * np.outer([1, 2, 3], [1, 2, 3])
    np.testing.assert_allclose(np.diag(about), np.array([4, 9, 16]) * 24 / 12)


def test_mirroring_keeps_faces_outward():
    solid = g.cone(1, 0.5, 2).scaled(-1, 1, 1)
    assert solid.volume > 0


def test_shell_parts_fill_the_wall_exactly():
    outer, inner = [(0.3, 0), (0.5, 0.4), (0.5, 1)], [(0.25, 0), (0.45, 0.4), (0.45, 1)]
    parts = shell_parts(outer, inner, 12)
    wall = g.lathe([*outer, *inner[::-1]], 12)
    assert len(parts) == 24 and all(p.bulge() < 1e-9 and p.is_closed() for p in parts)
    assert sum(p.volume for p in parts) == pytest.approx(wall.volume)


def test_tray_parts_do_not_overlap():
    parts = tray_parts(0.3, 0.1, 0.2, 0.01)
    solid = g.box(0.3, 0.1, 0.2).at(y=0.05) - g.box(0.28, 0.2, 0.18).at(y=0.11)
    assert sum(p.volume for p in parts) == pytest.approx(solid.volume)


def test_hull_drops_inner_points():
    corners = g.box(1, 1, 1).vertices
    assert len(hull(np.vstack([corners, [[0, 0, 0.2]]])).vertices) == 8
