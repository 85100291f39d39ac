"""089_globe, 090_trophy and 045_sand-clock: ornaments."""

from functools import partial

import numpy as np

from rtphys.assets.asset_model import AssetModel, Body, Part
from rtphys.assets.geometry import ball, box, cone, cylinder, lathe, rounded, rounded_box, tube
from rtphys.assets.material import Colour, Finish, Picture, matt, metal, plastic
from rtphys.assets.objects import Models
from rtphys.assets.parts import shell_parts
from rtphys.assets.pictures import to_picture
from rtphys.assets.solid import Solid, hull, together
from rtphys.core.seeds import stream

SIDES = 16


def globe(
    radius: float, height: float, sea: Colour, foot: Finish, words: tuple[str, ...]
) -> AssetModel:
    """A globe in a half ring on a round foot, its axis tilted as the earth's."""
    middle = height - radius - 0.006
    ring_r = radius + 0.006
    sphere = ball(radius, 20).turned("z", -23.4).at(y=middle)
    base = lathe(rounded([(0, 0), (0.055, 0), (0.055, 0.010), (0.014, 0.022), (0.009, 0.034),
                          (0, 0.034)], 0.004, 2, closed=False), SIDES)  # fmt: skip
    turns = np.radians(np.arange(-113, 68, 15))
    path = np.stack([ring_r * np.cos(turns), ring_r * np.sin(turns) + middle, 0 * turns], axis=1)
    arc = tube(path * [1, 1, 1], 0.0035, 6)
    stem = cylinder(0.006, 0.03, 10).at(y=0.032)
    earth = plastic((1, 1, 1), 0.6).with_picture(_earth(sea), "cylinder")
    ground = middle - radius - 0.006
    neck = cylinder(0.008, max(ground - 0.030, 0.006) + 0.01, 10).at(y=(ground + 0.030) / 2)
    looks = (
        Part(sphere, earth, "plastic", 60),
        Part(together(base, stem, neck, arc), foot, "steel", 50),
    )
    hoop = cylinder(0.006, 0.012, 8).turned("x", 90)
    arc_parts = tuple(hoop.at(*p) for p in path[2::2])
    foot_part = cone(0.055, 0.012, 0.034, SIDES)
    parts = (hull(ball(radius, 14).at(y=middle).vertices), foot_part, neck, *arc_parts)
    return _thing(looks, parts, 0.42, words, "globe")


def trophy(
    size: tuple[float, float, float], gold: Finish, plinth: Colour, words: tuple[str, ...]
) -> AssetModel:
    """A cup with two handles on a plinth; x over the handles, height, radius of the cup [m]."""
    wide, top, r = size
    low = 0.24 * top
    block = rounded_box(1.5 * r, 0.20 * top, 1.5 * r, 0.004, 1).at(y=0.10 * top)
    plate = box(0.9 * r, 0.09 * top, 0.002).at(0, 0.10 * top, 0.75 * r)
    stem_profile = [(0, 0.19 * top), (0.62 * r, 0.19 * top), (0.20 * r, low + 0.05 * top),
                    (0.16 * r, 0.42 * top), (0.28 * r, 0.47 * top), (0, 0.47 * top)]  # fmt: skip
    stem = lathe(stem_profile, SIDES)
    outer = [(0.28 * r, 0.45 * top), (0.78 * r, 0.58 * top), (0.94 * r, 0.80 * top), (r, top)]
    inner = [(0.20 * r, 0.48 * top), (0.70 * r, 0.60 * top), (0.86 * r, 0.80 * top)]
    inner.append((0.92 * r, top))
    cup = lathe([(0, 0.45 * top), *outer, *inner[::-1], (0, 0.48 * top)], SIDES)
    turns = np.radians(np.arange(-80, 91, 24))
    reach = wide / 2 - 0.80 * r
    ear = np.stack([0.74 * r + reach * np.cos(turns), 0.76 * top + 0.15 * top * np.sin(turns),
                    0 * turns], axis=1)  # fmt: skip
    bar = tube(ear, 0.0042, 6)
    ears = bar + bar.turned("y", 180)
    looks = (
        Part(together(stem, cup, ears), gold, "steel", 50),
        Part(block, plastic(plinth, 0.6), "wood"),
        Part(plate, metal((0.85, 0.85, 0.86), 0.3), "steel"),
    )
    bead = cylinder(0.005, 0.01, 8).turned("x", 90)
    handles = [bead.at(s * p[0], p[1], 0) for p in ear[1:-1:2] for s in (-1, 1)]
    parts = (block, stem_hull(r, top), *shell_parts(outer, inner, 8), *handles)
    return _thing(looks, parts, 0.55, words, "trophy")


def stem_hull(r: float, top: float) -> Solid:
    """The stem as a plain column."""
    return cylinder(0.30 * r, 0.29 * top, 12).at(y=0.335 * top)


def sand_clock(
    size: tuple[float, float], wood: Finish, sand: Colour, words: tuple[str, ...]
) -> AssetModel:
    """Two glass bulbs between two plates and three posts; radius of the plates, height [m]."""
    r, top = size
    t, half = 0.012, top / 2
    plates = [cylinder(r, t, 20).at(y=y) for y in (t / 2, top - t / 2)]
    bulb_r, waist = 0.62 * r, 0.007
    profile = [(0, t), (0.6 * bulb_r, t), (bulb_r, t + 0.20 * half), (bulb_r, t + 0.45 * half),
               (waist, half), (bulb_r, top - t - 0.45 * half), (bulb_r, top - t - 0.20 * half),
               (0.6 * bulb_r, top - t), (0, top - t)]  # fmt: skip
    bulbs = lathe(profile, SIDES)
    heap = lathe([(0, t + 0.02 * half), (1.03 * bulb_r, t + 0.21 * half),
                  (1.03 * bulb_r, t + 0.36 * half), (0, t + 0.60 * half)], SIDES)  # fmt: skip
    rest = lathe([(0, half), (waist * 1.2, half), (0.72 * bulb_r, half + 0.34 * half),
                  (0, half + 0.34 * half)], SIDES)  # fmt: skip
    post = cylinder(0.006, top - 2 * t, 8).at(0.82 * r, half, 0)
    posts = [post.turned("y", 120 * k + 30) for k in range(3)]
    looks = (
        Part(together(*plates, *posts), wood, "wood"),
        Part(bulbs, plastic((0.80, 0.90, 0.93), 0.9), "glass", 50),
        Part(heap + rest, matt(sand), "food", 50),
    )
    middle = cylinder(bulb_r, 0.36 * top, 12)
    parts = (*plates, *posts, middle.at(y=0.28 * top), middle.at(y=0.72 * top))
    return _thing(looks, parts, 0.48, words, "sand clock")


def _thing(
    looks: tuple[Part, ...],
    parts: tuple[Solid, ...],
    mass: float,
    words: tuple[str, ...],
    kind: str,
) -> AssetModel:
    return AssetModel(
        body=Body(looks, parts, mass),
        material="wood",
        description=words,
        categories=(kind, "ornament"),
    )


def _earth(sea: Colour) -> Picture:
    """Lands as blobs of summed waves, ice at the poles."""
    rng = stream(0, "assets", "globe")
    y, x = np.mgrid[0:32, 0:64]
    u, v = 2 * np.pi * x / 64, np.pi * (y + 0.5) / 32
    height = np.zeros((32, 64))
    for k in range(1, 5):
        for n in range(1, 4):
            a, b = rng.uniform(0, 2 * np.pi, 2)
            height += np.sin(k * u + a) * np.sin(n * v + b) * np.sin(v) / (k + n)
    picture = np.where((height > 0.22)[..., None], (0.30, 0.58, 0.25), sea)
    picture = np.where((height > 0.60)[..., None], (0.72, 0.62, 0.38), picture)
    picture[:3], picture[-3:] = 0.95, 0.95
    return to_picture(picture)


GOLD, SILVER = metal((0.90, 0.72, 0.25), 0.25), metal((0.82, 0.83, 0.86), 0.25)
BRONZE = metal((0.72, 0.46, 0.25), 0.3)
WALNUT, BEECH, BLACK = matt((0.40, 0.24, 0.14)), matt((0.82, 0.64, 0.42)), (0.10, 0.10, 0.11)

MODELS: Models = {
    "045_sand-clock": {
        0: partial(
            sand_clock,
            (0.0640, 0.190),
            WALNUT,
            (0.92, 0.72, 0.36),
            ("sand clock", "hourglass", "big hourglass", "wooden hourglass with yellow sand"),
        ),
        3: partial(
            sand_clock,
            (0.0480, 0.190),
            BEECH,
            (0.30, 0.55, 0.85),
            ("hourglass with blue sand", "slim hourglass", "blue sand clock", "sand timer"),
        ),
    },
    "089_globe": {
        3: partial(
            globe,
            0.0720,
            0.190,
            (0.20, 0.45, 0.80),
            metal((0.55, 0.42, 0.22), 0.35),
            ("globe", "blue globe", "desk globe", "globe on a stand"),
        ),
    },
    "090_trophy": {
        0: partial(
            trophy,
            (0.150, 0.190, 0.052),
            GOLD,
            BLACK,
            ("golden trophy", "trophy", "gold cup with two handles", "winner's cup"),
        ),
        3: partial(
            trophy,
            (0.095, 0.188, 0.033),
            SILVER,
            (0.42, 0.25, 0.15),
            ("silver trophy", "slim silver cup", "small trophy", "silver prize cup"),
        ),
        4: partial(
            trophy,
            (0.122, 0.187, 0.046),
            BRONZE,
            (0.16, 0.30, 0.22),
            ("bronze trophy", "bronze cup", "brown trophy", "prize cup with handles"),
        ),
    },
}
