"""Lathe-turned solids that may lie on their side: bottles, cans, jars.

Radii are half widths across flats, and facets face +-x and +-z. So the object rests on a flat
side, and it is exactly as wide between the fingers as its sizes say.
"""

import numpy as np
from numpy.typing import NDArray

from rtphys.assets.geometry import Outline, lathe
from rtphys.assets.solid import Solid, hull

SIDES = 16  # a multiple of 4, at most 24: the engine has no rolling resistance, facets have
# PhysX drops corners where a long facet bends slightly, and an object that lies on the rest of
# such a facet rocks for ever. Facets longer than this [m] get a part of their own.
LONG = 0.05

Array = NDArray[np.float64]


def turned(profile: Outline, sides: int = SIDES) -> Solid:
    """A profile (N, 2) of (half width, y) revolved about y; closed as in `lathe`."""
    points = np.array(profile, float)
    points[:, 0] /= np.cos(np.pi / sides)
    return lathe(points, sides).turned("y", 180 / sides)


def ring(radius: float, low: float, high: float, depth: float = 0.001) -> Solid:
    """A sleeve around a turned solid, such as a label, with its outside at `radius` [m]."""
    inner = radius - depth
    return turned([(radius, low), (radius, high), (inner, high), (inner, low)])


def disc(radius: float, low: float, high: float) -> Solid:
    """A flat cylinder between two heights."""
    return turned([(0, low), (radius, low), (radius, high), (0, high)])


def turned_parts(profile: Outline, sides: int = SIDES) -> tuple[Solid, ...]:
    """Convex parts of a turned solid: one for each convex stretch of the profile.

    Args:
        profile: (N, 2) of (half width, y), y never falling, from axis to axis.
        sides: corners around, as drawn.
    """
    points = [(r, y) for r, y in np.asarray(profile, float) if r > 0]
    pieces: list[list[tuple[float, float]]] = [[points[0]]]
    for point in points[1:]:
        piece = pieces[-1]
        alone = _long(piece[-1], point) or _long(piece[-2:][0], piece[-1])
        if len(piece) > 1 and (alone or _bends_inward(piece[-2], piece[-1], point)):
            # Where it widens at once, the next part starts at this height.
            pieces.append([piece[-1], point])
        else:
            piece.append(point)
    return tuple(_piece(piece, sides) for piece in pieces if piece[-1][1] - piece[0][1] > 1e-6)


def split(profile: Outline, height: float) -> tuple[Array, Array]:
    """Split a profile at `height`, such as the level of the contents, into two closed ones."""
    points = np.asarray(profile, float)
    radius = float(np.interp(height, points[:, 1], points[:, 0]))
    cut = [(radius, height), (0, height)]
    below = [p for p in points if p[1] < height]
    above = [p for p in points if p[1] > height]
    return np.array([*below, *cut]), np.array([*cut[::-1], *above])


def _piece(points: list[tuple[float, float]], sides: int) -> Solid:
    angles = 2 * np.pi * (np.arange(sides) + 0.5) / sides
    circle = np.stack([np.cos(angles), np.zeros(sides), np.sin(angles)], axis=1)
    rows = [r / np.cos(np.pi / sides) * circle + [0, y, 0] for r, y in points]
    return hull(np.vstack(rows))


def _long(a: tuple[float, float], b: tuple[float, float]) -> bool:
    return abs(b[1] - a[1]) > LONG


def _bends_inward(a: tuple[float, float], b: tuple[float, float], c: tuple[float, float]) -> bool:
    """Whether the outside, followed upward from a to c, turns away from the axis at b."""
    return (b[0] - a[0]) * (c[1] - b[1]) - (b[1] - a[1]) * (c[0] - b[0]) < -1e-12
