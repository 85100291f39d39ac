"""048_stapler: a base and an arm that rises to the front (+z), the free end to press.

The official grasp of models 5 and 6 lies above their tops; here it is inside the arm.
"""

from dataclasses import dataclass
from functools import partial

import numpy as np

from rtphys.assets.asset_model import AssetModel, Body, Part, contact
from rtphys.assets.geometry import box
from rtphys.assets.material import Colour, metal, plastic, tint
from rtphys.assets.objects import Models
from rtphys.assets.swept import bevelled, side_profile

LENGTH = 0.096  # [m]
STEEL = metal((0.80, 0.81, 0.83), 0.3)


@dataclass(frozen=True)
class Stapler:
    """Sizes [m] and mass [kg]."""

    width: float
    height: float
    press: tuple[float, float]  # z, y of the point to press
    grip: float  # y of the grasps
    hump: float  # z of the arm's highest point, as a share of the length
    mass: float


def stapler(size: Stapler, arm: Colour, base: Colour, words: tuple[str, ...]) -> AssetModel:
    """A desk stapler, arm open as it stands."""
    w, h = size.width, size.height
    foot = bevelled(_scaled([(-0.5, 0), (0.5, 0), (0.49, 0.16), (-0.5, 0.18)], h), w, 0.0015)
    hinge = bevelled(
        _scaled([(-0.5, 0.1), (-0.27, 0.1), (-0.30, 0.55), (-0.46, 0.62), (-0.5, 0.5)], h),
        0.96 * w,
        0.0015,
    )
    top = bevelled(_arm(size), w, min(0.0035, 0.18 * w))
    rail = _scaled([(-0.42, 0.36), (0.47, 0.47), (0.47, 0.60), (-0.42, 0.5)], h)
    magazine = side_profile(rail, 0.62 * w)
    anvil = box(0.5 * w, 0.0015, 0.014).at(0, 0.165 * h + 0.0006, 0.41 * LENGTH)
    # A softer pad marks where to press and which way the stapler points.
    z, pad_y = size.press[0], _top_at(size, size.press[0])
    pad = box(0.72 * w, 0.0012, 0.018).at(0, pad_y, z)
    looks = (
        Part(foot + hinge, plastic(base, 0.4), "steel"),
        Part(top, plastic(arm, 0.6), "plastic"),
        Part(magazine + anvil, STEEL, "aluminium"),
        Part(pad, plastic(tint(arm, 0.55), 0.1), "rubber"),
    )
    y = (0, 1, 0)
    return AssetModel(
        body=Body(looks, (foot, hinge, top, magazine), size.mass),
        material="plastic",
        description=words,
        contact_points=(
            contact((0, size.grip, 0), y, (0, 0, -1)),
            contact((0, size.grip, 0), y, (0, 0, 1)),
            contact((0, size.press[1], z), y, (0, 0, 1)),
        ),
        categories=("stapler", "office"),
    )


def _arm(size: Stapler) -> np.ndarray:
    k = size.hump
    shape = [(-0.5, 0.46), (0.46, 0.55), (0.5, 0.62), (0.49, 0.84), (max(k, 0.1) + 0.2, 0.96)]
    shape += [(k, 1.0), (k - 0.25, 0.96), (-0.44, 0.74), (-0.5, 0.62)]
    return _scaled(shape, size.height)


def _top_at(size: Stapler, z: float) -> float:
    """Height of the arm's upper side at z."""
    upper = _arm(size)[3:]
    return float(np.interp(z, upper[::-1, 0], upper[::-1, 1]))


def _scaled(shares: list[tuple[float, float]], height: float) -> np.ndarray:
    return np.array(shares) * [LENGTH, height]


RED, BLACK, BLUE = (0.80, 0.10, 0.10), (0.10, 0.10, 0.11), (0.12, 0.30, 0.72)
GREY, WHITE, GREEN = (0.45, 0.46, 0.48), (0.90, 0.90, 0.88), (0.20, 0.58, 0.30)
ORANGE, PINK, TEAL = (0.92, 0.48, 0.10), (0.92, 0.52, 0.62), (0.10, 0.55, 0.55)

ROWS: tuple[tuple[Stapler, Colour, Colour, tuple[str, ...]], ...] = (
    (
        Stapler(0.0229, 0.0473, (0.0350, 0.0468), 0.0289, 0.05, 0.21),
        RED,
        BLACK,
        ("red stapler", "stapler", "red and black stapler", "stapler with a red arm"),
    ),
    (
        Stapler(0.0297, 0.0412, (0.0325, 0.0402), 0.0300, 0.12, 0.24),
        BLACK,
        GREY,
        ("black stapler", "wide stapler", "black desk stapler", "stapler on a grey base"),
    ),
    (
        Stapler(0.0236, 0.0408, (0.0279, 0.0404), 0.0290, 0.20, 0.19),
        BLUE,
        BLACK,
        ("blue stapler", "stapler", "blue and black stapler", "low blue stapler"),
    ),
    (
        Stapler(0.0185, 0.0450, (0.0362, 0.0453), 0.0320, 0.22, 0.16),
        TEAL,
        WHITE,
        ("teal stapler", "narrow stapler", "slim teal stapler", "stapler on a white base"),
    ),
    (
        Stapler(0.0331, 0.0495, (0.0161, 0.0495), 0.0350, 0.14, 0.34),
        GREY,
        BLACK,
        ("grey stapler", "heavy stapler", "big grey stapler", "office stapler"),
    ),
    (
        Stapler(0.0204, 0.0344, (0.0320, 0.0340), 0.0240, 0.0, 0.12),
        ORANGE,
        GREY,
        ("orange stapler", "small stapler", "orange mini stapler", "little orange stapler"),
    ),
    (
        Stapler(0.0373, 0.0360, (0.0340, 0.0352), 0.0240, 0.10, 0.22),
        PINK,
        WHITE,
        ("pink stapler", "flat stapler", "pink and white stapler", "broad pink stapler"),
    ),
)

MODELS: Models = {"048_stapler": {i: partial(stapler, *row) for i, row in enumerate(ROWS)}}
