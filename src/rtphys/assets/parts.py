"""Exact convex parts of hollow objects, generated with the visual and not decomposed from it."""

from itertools import pairwise

import numpy as np

from rtphys.assets.geometry import Outline, box
from rtphys.assets.solid import Solid, hull


def shell_parts(outer: Outline, inner: Outline, sectors: int = 12) -> tuple[Solid, ...]:
    """The wall of a lathe-turned vessel: one convex part per sector and profile step.

    Args:
        outer: (N, 2) of (radius, y) along the outside, bottom to top.
        inner: (N, 2) along the inside, point i facing point i of `outer`. The four corners of
            each step must form a convex quadrilateral.
        sectors: parts around; the wall is a polygon of so many sides, its corners on the circle.

    Returns:
        sectors * (N - 1) parts. A step whose inside lies on the axis becomes a wedge.
    """
    a, b = np.asarray(outer, float), np.asarray(inner, float)
    edges = 2 * np.pi * np.arange(sectors + 1) / sectors
    parts = []
    for t0, t1 in pairwise(edges):
        for i in range(len(a) - 1):
            quad = np.array([a[i], a[i + 1], b[i + 1], b[i]])
            points = [(r * np.cos(t), y, -r * np.sin(t)) for r, y in quad for t in (t0, t1)]
            parts.append(hull(np.unique(np.round(points, 9), axis=0)))
    return tuple(parts)


def tray_parts(x: float, y: float, z: float, wall: float) -> tuple[Solid, ...]:
    """An open box as five cuboids: a floor from y = 0 and four walls up to `y`, centred in xz."""
    h = y - wall
    side = box(wall, h, z)
    end = box(x - 2 * wall, h, wall)
    middle = wall + h / 2
    return (
        box(x, wall, z).at(y=wall / 2),
        side.at(-(x - wall) / 2, middle),
        side.at((x - wall) / 2, middle),
        end.at(0, middle, -(z - wall) / 2),
        end.at(0, middle, (z - wall) / 2),
    )
