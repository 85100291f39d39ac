"""160_ramen-box: cups of instant noodles with a paper lid."""

from functools import partial

import numpy as np

from rtphys.assets.asset_model import AssetModel, Body, Part
from rtphys.assets.geometry import box, cone, cylinder
from rtphys.assets.lettering import write
from rtphys.assets.material import Colour, Picture, plastic
from rtphys.assets.objects import Models
from rtphys.assets.pictures import plain, to_picture

SIDES = 20


def ramen(
    size: tuple[float, float, float], colour: Colour, accent: Colour, words: tuple[str, ...]
) -> AssetModel:
    """A cup that widens upward; radii of the foot and the rim, height [m]."""
    low, high, tall = size
    cup = cone(low, high, tall - 0.003, SIDES)
    rim = cylinder(high + 0.002, 0.005, SIDES).at(y=tall - 0.0035)
    lid = cylinder(high, 0.0012, SIDES).at(y=tall - 0.0005)
    tab = box(0.014, 0.0012, 0.014).at(high + 0.006, tall - 0.0006, 0)
    from_y, to_y = 0.08 * tall, 0.88 * tall
    start, end = (1.006 * (low + (high - low) * y / tall) for y in (from_y, to_y))
    sleeve = cone(start, end, to_y - from_y, SIDES).at(y=from_y)
    print_ = plastic((1, 1, 1), 0.4).with_picture(_wrap(colour, accent), "cylinder")
    looks = (
        Part(cup + rim, plastic((0.95, 0.94, 0.90), 0.4), "cardboard"),
        Part(sleeve, print_, "paper", 50),
        Part(lid, plastic((1, 1, 1), 0.6).with_picture(_lid(colour, accent), "y"), "paper"),
        Part(tab, plastic(colour, 0.5), "paper"),
    )
    parts = (
        cone(low, high, tall - 0.006, SIDES),
        cylinder(high + 0.002, 0.006, SIDES).at(y=tall - 0.003),
        box(0.014, 0.002, 0.014).at(high + 0.006, tall - 0.001, 0),
    )
    return AssetModel(
        body=Body(looks, parts, 0.09),
        material="cardboard",
        description=words,
        categories=("ramen box", "food"),
    )


def _wrap(colour: Colour, accent: Colour) -> Picture:
    canvas = plain(colour, 64, 24)
    canvas[:3], canvas[-4:] = accent, accent
    for middle in (16, 48):  # centred at +z and -z
        canvas[6:18, middle - 12 : middle + 12] = (0.97, 0.95, 0.88)
        write(canvas[:, middle - 12 : middle + 12], "RAMEN", 9, colour)
    return to_picture(canvas)


def _lid(colour: Colour, accent: Colour) -> Picture:
    """A bowl of noodles seen from above."""
    y, x = np.mgrid[0:48, 0:48] - 23.5
    r = np.hypot(x, y)
    canvas = np.broadcast_to(np.array(colour), (48, 48, 3)).copy()
    canvas[r < 17] = accent
    canvas[r < 14] = (0.95, 0.80, 0.40)
    waves = np.sin(0.9 * x + 1.5 * np.sin(0.5 * y)) > 0.4
    canvas[(r < 14) & waves] = (0.85, 0.62, 0.22)
    canvas[np.hypot(x - 5, y + 4) < 4.5] = (0.98, 0.97, 0.92)
    canvas[np.hypot(x - 5, y + 4) < 2.2] = (0.98, 0.68, 0.12)
    canvas[(np.abs(x + 6) < 3) & (np.abs(y - 3) < 5)] = (0.12, 0.32, 0.18)
    return to_picture(canvas)


RED, YELLOW, GREEN = (0.80, 0.12, 0.10), (0.98, 0.80, 0.15), (0.15, 0.48, 0.24)
BLUE, WHITE = (0.12, 0.28, 0.62), (0.95, 0.95, 0.93)

MODELS: Models = {
    "160_ramen-box": {
        0: partial(
            ramen,
            (0.036, 0.048, 0.108),
            RED,
            YELLOW,
            ("cup of ramen", "red noodle cup", "instant noodles", "red ramen cup"),
        ),
        1: partial(
            ramen,
            (0.050, 0.070, 0.070),
            GREEN,
            WHITE,
            ("green noodle bowl", "ramen bowl", "wide noodle cup", "green ramen box"),
        ),
        2: partial(
            ramen,
            (0.034, 0.043, 0.090),
            BLUE,
            YELLOW,
            ("blue noodle cup", "small ramen cup", "blue ramen cup", "seafood noodles"),
        ),
    },
}
