"""Solids from cross-sections: extruded side profiles, and lofts through rows of rings."""

from collections.abc import Sequence
from itertools import pairwise

import numpy as np
from numpy.typing import ArrayLike, NDArray

from rtphys.assets.geometry import Outline, extrude, lathe
from rtphys.assets.solid import Solid, hull

Array = NDArray[np.float64]


def side_profile(outline: Outline, width: float) -> Solid:
    """A closed outline (N, 2) of (z, y) points, seen from the side, extruded by `width` along x."""
    flat = extrude(outline, width).at(y=-width / 2)
    return Solid(flat.vertices[:, [1, 2, 0]], flat.faces)


def bevelled(outline: Outline, width: float, bevel: float) -> Solid:
    """`side_profile` of a convex outline with edges bevelled by about `bevel` [m]. Convex."""
    p = np.asarray(outline, float)
    middle = (p.min(0) + p.max(0)) / 2
    half = np.ptp(p, axis=0) / 2
    small = middle + (p - middle) * np.maximum(1 - bevel / np.maximum(half, 1e-9), 0.2)
    rows = [(p, width / 2 - bevel), (small, width / 2)]
    return hull([(s * x, y, z) for points, x in rows for s in (-1, 1) for z, y in points])


def lying(profile: Outline, sides: int = 12, rest: float | None = None) -> Solid:
    """A profile (N, 2) of (radius, z) revolved about z, lying on the ground on one facet.

    `sides` is even; `rest` is the radius that touches the ground, by default the largest.
    """
    p = np.asarray(profile, float)
    low = (p[:, 0].max() if rest is None else rest) * np.cos(np.pi / sides)
    # Corners start on +x: a facet is underneath as it is, unless 4 divides the number of sides.
    turn = 180 / sides if sides % 4 == 0 else 0.0
    return lathe(p, sides).turned("y", turn).turned("x", 90).at(y=low)


def rod(radius: float, start: float, end: float, sides: int = 12) -> Solid:
    """A lying prism along z from `start` to `end`. Convex."""
    return lying([(0, start), (radius, start), (radius, end), (0, end)], sides)


def loft(rings: ArrayLike) -> Solid:
    """A solid through rings (K, N, 3): each is joined to the next, the ends are closed by fans."""
    r = np.asarray(rings, float)
    count, sides = r.shape[:2]
    i, j = np.arange(sides), np.roll(np.arange(sides), -1)
    faces = []
    for k in range(count - 1):
        a, b = k * sides, (k + 1) * sides
        faces += [np.stack([a + i, a + j, b + j], 1), np.stack([a + i, b + j, b + i], 1)]
    first, last, end = count * sides, count * sides + 1, (count - 1) * sides
    faces += [np.stack([np.full(sides, first), j, i], 1)]
    faces += [np.stack([np.full(sides, last), end + i, end + j], 1)]
    vertices = np.vstack([r.reshape(-1, 3), r[0].mean(0), r[-1].mean(0)])
    solid = Solid(vertices, np.vstack(faces).astype(np.int64))
    return Solid(vertices, solid.faces[:, ::-1]) if solid.volume < 0 else solid


def slabs(rings: ArrayLike, stops: Sequence[int]) -> tuple[Solid, ...]:
    """Convex parts of a loft: one hull from each ring index in `stops` to the next."""
    r = np.asarray(rings, float)
    return tuple(hull(r[a : b + 1].reshape(-1, 3)) for a, b in pairwise(stops))


def dome(width: float, height: float, z: float, sides: int = 12, power: float = 2.5) -> Array:
    """Ring (sides, 3) at z: an arch on the ground, elliptic at `power` 2, squarer above it."""
    t = np.linspace(0, np.pi, sides)
    x = width / 2 * np.sign(np.cos(t)) * np.abs(np.cos(t)) ** (2 / power)
    y = height * np.abs(np.sin(t)) ** (2 / power)
    return np.stack([x, y, np.full(sides, z)], axis=1)


def oval(width: float, height: float, z: float, sides: int = 16, power: float = 2.0) -> Array:
    """Ring (sides, 3) at z about the z axis: an ellipse at `power` 2, squarer above it."""
    t = 2 * np.pi * (np.arange(sides) + 0.5) / sides
    x = width / 2 * np.sign(np.cos(t)) * np.abs(np.cos(t)) ** (2 / power)
    y = height / 2 * np.sign(np.sin(t)) * np.abs(np.sin(t)) ** (2 / power)
    return np.stack([x, y, np.full(sides, z)], axis=1)
