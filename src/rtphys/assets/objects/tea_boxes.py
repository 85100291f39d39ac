"""112_tea-box: cartons and tins of tea. Model 0 is narrower than the official one, to be held."""

from functools import partial

import numpy as np

from rtphys.assets.asset_model import AssetModel, Body, from_above, from_sides, functional
from rtphys.assets.lettering import write
from rtphys.assets.material import Colour, Picture
from rtphys.assets.objects import Models
from rtphys.assets.packets import Packet, Print, dark, packet
from rtphys.assets.pictures import plain, to_picture

Leaf = tuple[Colour, Colour]  # page and leaf


def tea_box(
    size: Packet, colour: Colour, lid: Colour, leaf: Leaf, words: tuple[str, ...]
) -> AssetModel:
    """A packet of tea with a leaf on every side."""
    look = Print(colour, lid, _front(*leaf, "TEA"), _front(*leaf, ""))
    visual, parts = packet(size, look)
    down = functional((0, 0, 0), (0, -1, 0), (0, 0, 1))
    up = functional((0, 0, 0), (0, 1, 0), (0, 0, -1))
    return AssetModel(
        body=Body(visual, parts, size.mass),
        material="cardboard" if size.kind == "carton" else "steel",
        description=words,
        contact_points=from_above((0, size.above, 0)) + from_sides(size.aside, (0, 90, 180, 270)),
        functional_points=(down, up),
        categories=("tea box", "food"),
    )


def _front(page: Colour, ink: Colour, word: str) -> Picture:
    """Two leaves on a page, and the word below."""
    canvas = plain(page, 40, 40)
    y, x = np.mgrid[0:40, 0:40].astype(float)
    up = 14 if word else 19
    for side in (-1, 1):
        u = (x - 19.5 - side * 6) * 0.75 + side * (y - up) * 0.66
        v = -side * (x - 19.5 - side * 6) * 0.66 + (y - up) * 0.75
        canvas[(u / 4.6) ** 2 + (v / 10.5) ** 2 < 1] = ink
        canvas[(abs(u) < 0.7) & (abs(v) < 9.5)] = page
    if word:
        write(canvas, word, 27, dark(ink), 2)
    canvas[:2], canvas[-2:] = ink, ink
    return to_picture(canvas)


CREAM, GREEN, LIME = (0.95, 0.92, 0.80), (0.15, 0.50, 0.22), (0.55, 0.75, 0.25)
RED, GOLD, NAVY = (0.72, 0.14, 0.12), (0.85, 0.68, 0.30), (0.12, 0.20, 0.42)
WHITE, TEAL, PLUM = (0.95, 0.95, 0.94), (0.12, 0.50, 0.50), (0.45, 0.18, 0.42)

Row = tuple[Packet, Colour, Colour, Leaf, tuple[str, ...]]
ROWS: tuple[Row, ...] = (
    (
        Packet(0.0840, 0.0715, 0.0715, "carton", 0.0454, 0.0309, 0.105),
        GREEN,
        LIME,
        (CREAM, GREEN),
        ("green tea box", "tea box", "box of green tea", "green tea carton"),
    ),
    (
        Packet(0.0770, 0.0676, 0.0730, "prism", 0.0418, 0.0294, 0.140),
        RED,
        GOLD,
        (CREAM, RED),
        ("red tea tin", "tin of tea", "red tea caddy", "red and gold tea box"),
    ),
    (
        Packet(0.0525, 0.0965, 0.0432, "carton", 0.0706, 0.0429, 0.075),
        NAVY,
        GOLD,
        (WHITE, NAVY),
        ("tall blue tea box", "blue tea box", "narrow tea carton", "blue box of tea"),
    ),
    (
        Packet(0.0776, 0.0696, 0.0750, "tin", 0.0436, 0.0296, 0.160),
        GOLD,
        GREEN,
        (CREAM, GREEN),
        ("golden tea tin", "tea tin with a green lid", "gold tea caddy", "square tea tin"),
    ),
    (
        Packet(0.0740, 0.0678, 0.0776, "carton", 0.0441, 0.0296, 0.095),
        PLUM,
        WHITE,
        (WHITE, PLUM),
        ("purple tea box", "box of herbal tea", "purple tea carton", "purple box with leaves"),
    ),
    (
        Packet(0.0776, 0.0760, 0.0776, "tin", 0.0600, 0.0411, 0.170),
        WHITE,
        TEAL,
        (WHITE, TEAL),
        ("white tea tin", "tea tin with a teal lid", "white tea caddy", "white tea box"),
    ),
)

MODELS: Models = {"112_tea-box": {i: partial(tea_box, *row) for i, row in enumerate(ROWS)}}
