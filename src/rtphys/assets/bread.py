"""Bread and other long soft shapes with a flat underside: loaves, buns, sausages."""

import numpy as np

from rtphys.assets.asset_model import Array
from rtphys.assets.geometry import box
from rtphys.assets.material import Colour, Picture, tint
from rtphys.assets.pictures import to_picture
from rtphys.assets.solid import Solid, hull, together
from rtphys.core.seeds import stream

FACETS = 10  # around the upper side


def bread(
    width: float, height: float, length: float, blunt: float = 0.5, flat: float = 0.7
) -> Solid:
    """A convex loaf shape along z that stands on y = 0.

    Args:
        width: across x [m].
        height: along y [m].
        length: along z [m].
        blunt: how full the ends are, 0 pointed to 1 square.
        flat: width of the underside as a share of `width`.
    """
    share = 0.5 + 0.5 * np.cos(np.linspace(np.pi, 0, 7)) - 0.5  # -0.5 .. 0.5, closer at the ends
    rings = [_ring(width * s, height * t, length * z, flat) for z, s, t in _profile(share, blunt)]
    return hull(np.vstack(rings))


def scored(body: Solid, width: float, height: float, length: float, count: int = 3) -> Solid:
    """Slanting cuts across the top of a loaf of these sizes, slightly raised over its crust."""
    skin = body.scaled(1.02).at(y=-0.0002)
    places = np.linspace(-0.26, 0.26, count) * length
    blade = box(0.75 * width, 0.5 * height, 0.006).turned("y", 30)
    return together(*(skin & blade.at(0, 0.9 * height, float(z)) for z in places))


def crust(colour: Colour, name: str, contrast: float = 0.10) -> Picture:
    """Baked dough seen from the side: dark on top, pale below, mottled."""
    rng = stream(0, "assets", "crust", name)
    fall = np.linspace(0.82, 1.12, 16)[:, None] * np.ones((16, 32))
    fall = fall * (1 + contrast * rng.normal(0, 0.5, (16, 32)))
    pale = np.array(tint(colour, 1.25))
    depth = np.clip(np.linspace(-0.6, 1.0, 16), 0, 1)[:, None, None]
    return to_picture((1 - depth) * np.array(colour) * fall[..., None] + depth * pale)


def _profile(share: Array, blunt: float) -> list[tuple[float, float, float]]:
    rows = []
    for z in share:
        full = np.sqrt(max(1 - (2 * z) ** 2, 0.0))
        size = blunt + (1 - blunt) * full
        rows.append((float(z), float(max(size, 0.08)), float(max(0.4 + 0.6 * size, 0.3))))
    return rows


def _ring(width: float, height: float, z: float, flat: float) -> Array:
    """Cross-section: half an ellipse over vertical sides (for the fingers) and a flat underside."""
    angles = np.linspace(0, np.pi, FACETS + 1)
    low = 0.5 * height
    back = np.stack([0.5 * width * np.cos(angles), low + (height - low) * np.sin(angles)], axis=1)
    sides = np.array([(-0.5 * width, 0.2 * height), (0.5 * width, 0.2 * height)])
    foot = np.array([(-0.5 * flat * width, 0.0), (0.5 * flat * width, 0.0)])
    points = np.vstack([back, sides, foot])
    return np.column_stack([points, np.full(len(points), z)])
