"""152_screwdriver, 163_wrench, 084_woodenmallet and 030_drill, lying except for the drill."""

from dataclasses import dataclass
from functools import partial

import numpy as np

from rtphys.assets.asset_model import AssetModel, Body, Part
from rtphys.assets.geometry import box, circle, cylinder, extrude, rounded_box
from rtphys.assets.material import Colour, matt, metal, plastic, tint
from rtphys.assets.objects import Models
from rtphys.assets.pictures import grain
from rtphys.assets.solid import Solid, hull, together
from rtphys.assets.swept import bevelled, lying, rod

STEEL = metal((0.78, 0.79, 0.82), 0.3)


@dataclass(frozen=True)
class Screwdriver:
    """Sizes [m] and mass [kg]."""

    grip: float  # length of the handle
    shaft: float
    radius: float
    mass: float


def screwdriver(
    size: Screwdriver, colour: Colour, cross: bool, words: tuple[str, ...]
) -> AssetModel:
    """A six sided handle, on which it lies, and a shaft to +z."""
    r, grip, end = size.radius, size.grip, size.shaft
    outline = [(0, -grip), (0.8 * r, -grip), (r, -0.88 * grip), (r, -0.10 * grip)]
    handle = lying([*outline, (0.6 * r, 0), (0, 0)], 6)
    y = r * np.cos(np.pi / 6)
    shaft = rod(0.0027, 0, end, 8).at(y=y - 0.0027 * np.cos(np.pi / 8))
    tip = box(0.0075 if not cross else 0.004, 0.0022 if not cross else 0.004, 0.012)
    band = lying([(0, -0.62 * grip), (1.04 * r, -0.62 * grip), (1.04 * r, -0.5 * grip),
                  (0, -0.5 * grip)], 6, rest=r)  # fmt: skip
    looks = (
        Part(handle, plastic(colour, 0.6), "plastic"),
        Part(band, plastic((0.10, 0.10, 0.11), 0.3), "rubber"),
        Part(shaft + tip.at(0, y, end - 0.004), STEEL, "steel"),
    )
    return _thing(looks, (rod(r, -grip, -0.1 * grip, 6), shaft), size.mass, words, "screwdriver")


def wrench(length: float, colour: Colour, words: tuple[str, ...]) -> AssetModel:
    """An open spanner, lying flat."""
    t, w = 0.008, 0.020
    bar = box(w, 0.75 * t, length - 0.05).at(y=t / 2)
    head = extrude(circle(0.021, 16), t).at(z=length / 2 - 0.021)
    mouth = box(0.017, 3 * t, 0.030).turned("y", 18).at(0.003, 0, length / 2 - 0.005)
    ring = extrude(circle(0.017, 16), t).at(z=-length / 2 + 0.017)
    hole = cylinder(0.0095, 3 * t, 6).at(z=-length / 2 + 0.017)
    line = box(0.5 * w, 0.76 * t, 0.55 * length).at(y=t / 2 + 0.0003)
    looks = (
        Part(bar + (head - mouth) + (ring - hole), STEEL, "steel"),
        Part(line, plastic(colour, 0.5), "steel"),
    )
    cheeks = [box(0.012, t, 0.036).at(s * 0.0145, t / 2, length / 2 - 0.021) for s in (-1, 1)]
    root = box(0.030, t, 0.016).at(0, t / 2, length / 2 - 0.032)
    return _thing(looks, (bar, root, *cheeks, ring), 0.16, words, "wrench")


def mallet(size: tuple[float, float, float], head: Colour, words: tuple[str, ...]) -> AssetModel:
    """A wooden mallet lying on its head and the handle's end, x y z [m]."""
    x, y, z = size
    wood = matt((0.80, 0.60, 0.38)).with_picture(grain((1.0, 1.0, 1.0), "mallet", 0.2), "y")
    deep = 0.30 * z
    block = rounded_box(x, y, deep, 0.006, 2).at(0, y / 2, z / 2 - deep / 2)
    root = z / 2 - deep / 2
    side = [(-z / 2, 0.0), (-z / 2, 0.022), (root, 0.55 * y), (root, 0.28 * y)]
    stem = bevelled(side, 0.022, 0.004)
    rim = rounded_box(1.01 * x, 1.004 * y, 0.14 * deep, 0.006, 1)
    rims = [rim.at(0, y / 2, z / 2 - deep / 2 + s * 0.30 * deep) for s in (-1, 1)]
    looks = (
        Part(block, matt(head), "wood"),
        Part(stem, wood, "wood"),
        Part(together(*rims), matt(tint(head, 0.6)), "leather"),
    )
    return _thing(looks, (block, stem), 0.30, words, "mallet")


def drill(colour: Colour, words: tuple[str, ...]) -> AssetModel:
    """A cordless drill standing on its battery, the bit to +z."""
    battery = rounded_box(0.045, 0.034, 0.095, 0.005, 2).at(0, 0.017, -0.012)
    grip = bevelled([(-0.030, 0.03), (0.010, 0.03), (0.000, 0.12), (-0.046, 0.12)], 0.034, 0.007)
    body = bevelled([(-0.058, 0.112), (0.022, 0.108), (0.030, 0.120), (0.026, 0.154),
                     (-0.052, 0.154), (-0.060, 0.14)], 0.044, 0.008)  # fmt: skip
    chuck = lying([(0, 0.024), (0.017, 0.024), (0.017, 0.046), (0.010, 0.056), (0, 0.056)], 12)
    chuck = chuck.at(y=0.131 - 0.017 * np.cos(np.pi / 12))
    bit = rod(0.003, 0.05, 0.069, 6).at(y=0.131 - 0.003 * np.cos(np.pi / 6))
    trigger = box(0.012, 0.022, 0.014).at(0, 0.098, 0.008)
    dark = plastic((0.12, 0.12, 0.13), 0.3)
    looks = (
        Part(body, plastic(colour, 0.5), "plastic"),
        Part(together(battery, grip), dark, "plastic"),
        Part(trigger, plastic((0.80, 0.15, 0.12), 0.5), "plastic"),
        Part(chuck + bit, metal((0.40, 0.41, 0.43), 0.4), "aluminium"),
    )
    parts = (battery, grip, body, hull(chuck.vertices), bit)
    return _thing(looks, parts, 1.15, words, "drill")


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
        categories=(kind, "tool"),
    )


RED, BLUE, YELLOW = (0.82, 0.14, 0.12), (0.14, 0.34, 0.75), (0.96, 0.76, 0.10)
GREEN, ORANGE, BEECH = (0.15, 0.52, 0.30), (0.94, 0.50, 0.10), (0.84, 0.66, 0.44)

MODELS: Models = {
    "030_drill": {
        6: partial(
            drill, YELLOW, ("yellow drill", "cordless drill", "power drill", "electric drill")
        ),
    },
    "084_woodenmallet": {
        3: partial(
            mallet,
            (0.0450, 0.0670, 0.1900),
            BEECH,
            ("wooden mallet", "mallet", "wooden hammer", "small mallet"),
        ),
    },
    "152_screwdriver": {
        0: partial(
            screwdriver,
            Screwdriver(0.095, 0.090, 0.0150, 0.085),
            RED,
            False,
            ("red screwdriver", "screwdriver", "flat screwdriver", "screwdriver with a red handle"),
        ),
        1: partial(
            screwdriver,
            Screwdriver(0.080, 0.060, 0.0165, 0.075),
            BLUE,
            True,
            ("blue screwdriver", "short screwdriver", "cross screwdriver", "thick screwdriver"),
        ),
        2: partial(
            screwdriver,
            Screwdriver(0.090, 0.110, 0.0130, 0.070),
            YELLOW,
            False,
            ("yellow screwdriver", "long screwdriver", "thin screwdriver", "long yellow tool"),
        ),
    },
    "163_wrench": {
        0: partial(wrench, 0.170, BLUE, ("wrench", "steel wrench", "spanner", "blue wrench")),
        1: partial(wrench, 0.140, RED, ("red wrench", "short wrench", "small spanner", "red tool")),
        2: partial(wrench, 0.200, GREEN, ("long wrench", "green wrench", "big spanner", "tool")),
    },
}
