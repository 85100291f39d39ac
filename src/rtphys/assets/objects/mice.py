"""047_mouse: a rounded shell along z, buttons and wheel towards +z."""

from dataclasses import dataclass
from functools import partial

import numpy as np

from rtphys.assets.asset_model import AssetModel, Body, Part, contact
from rtphys.assets.geometry import box, cylinder
from rtphys.assets.material import Colour, plastic, tint
from rtphys.assets.objects import Models
from rtphys.assets.swept import dome, loft, slabs

# Along the mouse: place, width and height as shares of its sizes.
ROUND = (
    (-0.5, 0.50, 0.30),
    (-0.46, 0.72, 0.58),
    (-0.36, 0.90, 0.84),
    (-0.15, 1.0, 1.0),
    (0.08, 0.95, 0.97),
    (0.30, 0.93, 0.76),
    (0.44, 0.86, 0.54),
    (0.5, 0.66, 0.36),
)
FLAT = (
    (-0.5, 0.58, 0.36),
    (-0.44, 0.86, 0.72),
    (-0.28, 1.0, 0.94),
    (-0.05, 0.98, 1.0),
    (0.20, 0.96, 0.92),
    (0.40, 0.94, 0.72),
    (0.5, 0.80, 0.46),
)


@dataclass(frozen=True)
class Mouse:
    """Sizes [m] and mass [kg]."""

    width: float
    height: float
    length: float
    power: float  # how boxy the cross-section is; below 3.5, steep sides slip out of the fingers
    mass: float


def mouse(
    size: Mouse, rows: tuple, shell: Colour, accent: Colour, words: tuple[str, ...]
) -> AssetModel:
    """A computer mouse."""
    w, h, length = size.width, size.height, size.length
    rings = np.array([dome(b * w, c * h, a * length, 12, size.power) for a, b, c in rows])
    body = loft(rings)
    parts = slabs(rings, (0, len(rows) // 2, len(rows) - 1))
    # Buttons: the front part once more, a hair larger, split by a dark slot.
    front = rings[len(rows) // 2 :] * [1.01, 1.0, 1.0] + [0, 0.0006, 0.0004]
    slot_z, slot = 0.27 * length, 0.46 * length
    top = float(np.interp(0.30, [r[0] for r in rows], [r[2] for r in rows])) * h
    wheel = (
        cylinder(0.19 * h + 0.003, 0.10 * w, 14).turned("z", 90).at(0, top - 0.004, 0.31 * length)
    )
    line = box(0.022 * w, 0.92 * h, slot).at(0, 0.5 * h, slot_z) & loft(
        rings + np.array([0, 0.0016, 0.001])
    )
    sole = box(0.7 * w, 0.001, 0.8 * length).at(y=0.0005)
    looks = (
        Part(body, plastic(shell, 0.5), "plastic", 50),
        Part(loft(front), plastic(tint(shell, 0.82), 0.6), "plastic", 50),
        Part(wheel, plastic(accent, 0.4), "rubber"),
        Part(line + sole, plastic((0.05, 0.05, 0.05), 0.3), "plastic"),
    )
    grip = (0, 0.5 * h, 0)
    return AssetModel(
        body=Body(looks, parts, size.mass),
        material="plastic",
        description=words,
        contact_points=(
            contact(grip, (0, 1, 0), (0, 0, 1)),
            contact(grip, (0, 1, 0), (0, 0, -1)),
        ),
        categories=("mouse", "electronics"),
    )


MODELS: Models = {
    "047_mouse": {
        0: partial(
            mouse,
            Mouse(0.0430, 0.0260, 0.0875, 4.0, 0.075),
            FLAT,
            (0.92, 0.92, 0.93),
            (0.25, 0.25, 0.27),
            ("white computer mouse", "white mouse", "flat mouse", "wireless white mouse"),
        ),
        1: partial(
            mouse,
            Mouse(0.0440, 0.0308, 0.0778, 3.6, 0.082),
            ROUND,
            (0.13, 0.13, 0.15),
            (0.80, 0.15, 0.12),
            ("black computer mouse", "black mouse", "round mouse", "mouse with a red wheel"),
        ),
        2: partial(
            mouse,
            Mouse(0.0720, 0.0470, 0.1300, 4.0, 0.125),
            ROUND,
            (0.20, 0.34, 0.62),
            (0.75, 0.78, 0.80),
            ("big blue mouse", "blue computer mouse", "large mouse", "gaming mouse"),
        ),
    }
}
