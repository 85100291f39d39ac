"""155_marker, 156_paint-brush, 157_toothbrush: long thin objects that lie along z."""

from functools import partial

import numpy as np

from rtphys.assets.asset_model import AssetModel, Body, Part
from rtphys.assets.geometry import box
from rtphys.assets.material import Colour, matt, metal, plastic
from rtphys.assets.objects import Models
from rtphys.assets.solid import Solid, hull, together
from rtphys.assets.swept import dome, loft, lying, rod, slabs


def marker(radius: float, length: float, ink: Colour, words: tuple[str, ...]) -> AssetModel:
    """A felt pen with its cap on; the clip keeps it from rolling."""
    r, half = radius, length / 2
    barrel = rod(r, -half + 0.008, 0.12 * length, 10)
    plug = rod(0.8 * r, -half, -half + 0.010, 10).at(y=0.2 * r)
    cap = lying([(0, 0.12 * length), (1.06 * r, 0.12 * length), (1.0 * r, half - 0.012),
                 (0.55 * r, half), (0, half)], 10, rest=r)  # fmt: skip
    clip = box(0.3 * r, 0.3 * r, 0.26 * length).at(0.98 * r, 0.95 * r, 0.28 * length)
    band = lying([(0, -0.30 * length), (1.01 * r, -0.30 * length), (1.01 * r, 0.02 * length),
                  (0, 0.02 * length)], 10, rest=r)  # fmt: skip
    looks = (
        Part(barrel, plastic((0.94, 0.94, 0.93), 0.5), "plastic"),
        Part(together(plug, cap, clip, band), plastic(ink, 0.5), "plastic"),
    )
    return _thing(looks, (rod(r, -half, half, 10),), 0.022, words, "marker")


def paint_brush(
    size: tuple[float, float], hair: Colour, grip: Colour, words: tuple[str, ...]
) -> AssetModel:
    """A flat brush; width and length [m], the bristles to +z."""
    wide, length = size
    half = length / 2
    places = (
        (-half, 0.30),
        (-0.8 * half, 0.46),
        (-0.45 * half, 0.32),
        (0.0, 0.42),
        (0.18 * half, 0.9),
    )
    rings = np.array([dome(s * wide, 0.014, z, 8, 4) for z, s in places])
    handle = loft(rings)
    collar = box(0.98 * wide, 0.016, 0.34 * half).at(0, 0.008, 0.34 * half)
    hairs = hull([
        *box(0.94 * wide, 0.013, 0.01).at(0, 0.0075, 0.5 * half).vertices,
        *box(0.98 * wide, 0.004, 0.002).at(0, 0.0055, half).vertices,
    ])  # fmt: skip
    looks = (
        Part(handle, plastic(grip, 0.6), "wood", 50),
        Part(collar, metal((0.80, 0.80, 0.82), 0.35), "aluminium"),
        Part(hairs, matt(hair), "fabric"),
    )
    parts = (*slabs(rings, (0, 2, 4)), collar, hairs)
    return _thing(looks, parts, 0.07, words, "paint brush")


def toothbrush(length: float, colour: Colour, hair: Colour, words: tuple[str, ...]) -> AssetModel:
    """A toothbrush on its back, the bristles up at +z."""
    half = length / 2
    places = ((-half, 0.008), (-0.9 * half, 0.013), (-0.3 * half, 0.014), (0.1 * half, 0.010),
              (0.55 * half, 0.007), (0.70 * half, 0.012), (half, 0.011))  # fmt: skip
    rings = np.array([dome(w, 0.007, z, 8, 4) for z, w in places])
    handle = loft(rings)
    bristles = box(0.010, 0.013, 0.26 * half).at(0, 0.0125, 0.85 * half)
    tip = box(0.010, 0.0133, 0.07 * half).at(0, 0.0125, 0.945 * half)
    pad = box(0.009, 0.002, 0.45 * half).at(0, 0.0068, -0.45 * half)
    looks = (
        Part(handle, plastic(colour, 0.6), "plastic", 50),
        Part(bristles, matt((0.96, 0.96, 0.95)), "fabric"),
        Part(tip + pad, plastic(hair, 0.3), "rubber"),
    )
    return _thing(looks, (*slabs(rings, (0, 3, 6)), bristles), 0.020, words, "toothbrush")


def _thing(
    looks: tuple[Part, ...],
    parts: tuple[Solid, ...],
    mass: float,
    words: tuple[str, ...],
    kind: str,
) -> AssetModel:
    return AssetModel(
        body=Body(looks, parts, mass),
        material="plastic",
        description=words,
        categories=(kind, "household"),
    )


RED, BLUE, GREEN = (0.82, 0.13, 0.12), (0.13, 0.33, 0.78), (0.15, 0.58, 0.30)
BLACK, YELLOW, PINK = (0.10, 0.10, 0.11), (0.96, 0.78, 0.12), (0.93, 0.45, 0.60)
TEAL, WOOD, CREAM = (0.12, 0.62, 0.62), (0.80, 0.58, 0.34), (0.90, 0.84, 0.68)

MODELS: Models = {
    "155_marker": {
        0: partial(marker, 0.0090, 0.135, RED, ("red marker", "red pen", "marker", "felt pen")),
        1: partial(
            marker,
            0.0110,
            0.125,
            BLACK,
            ("black marker", "thick marker", "black pen", "felt pen"),
        ),
        2: partial(
            marker,
            0.0080,
            0.145,
            GREEN,
            ("green marker", "thin marker", "green pen", "slim pen"),
        ),
    },
    "156_paint-brush": {
        0: partial(
            paint_brush,
            (0.050, 0.200),
            CREAM,
            RED,
            ("paint brush", "red brush", "flat brush", "red paint brush"),
        ),
        1: partial(
            paint_brush,
            (0.034, 0.175),
            BLACK,
            WOOD,
            ("wooden brush", "narrow brush", "brush", "small paint brush"),
        ),
        2: partial(
            paint_brush,
            (0.070, 0.210),
            WOOD,
            BLUE,
            ("wide brush", "blue brush", "big brush", "blue paint brush"),
        ),
    },
    "157_toothbrush": {
        0: partial(
            toothbrush,
            0.185,
            BLUE,
            TEAL,
            ("blue toothbrush", "toothbrush", "blue brush", "tooth brush"),
        ),
        1: partial(
            toothbrush,
            0.170,
            PINK,
            RED,
            ("pink toothbrush", "small toothbrush", "pink brush", "toothbrush"),
        ),
        2: partial(
            toothbrush,
            0.190,
            YELLOW,
            GREEN,
            ("yellow toothbrush", "yellow brush", "long toothbrush", "brush"),
        ),
    },
}
