"""113_coffee-box: coffee in cartons, tins and bags.

Side grasps are centred; the official ones are 2 mm towards -x."""

from functools import partial

import numpy as np

from rtphys.assets.asset_model import AssetModel, Body, from_above, from_sides
from rtphys.assets.lettering import write
from rtphys.assets.material import Colour, Picture
from rtphys.assets.objects import Models
from rtphys.assets.packets import Packet, Print, packet
from rtphys.assets.pictures import plain, to_picture

Label = tuple[Colour, Colour]  # page and ink


def coffee_box(
    size: Packet, colour: Colour, lid: Colour, label: Label, words: tuple[str, ...]
) -> AssetModel:
    """A packet of coffee: a steaming cup in front, a bean on the sides."""
    visual, parts = packet(size, Print(colour, lid, _cup(*label), _bean(*label)))
    return AssetModel(
        body=Body(visual, parts, size.mass),
        material="steel" if size.kind in ("tin", "can") else "cardboard",
        description=words,
        contact_points=from_above((0, size.above, 0)) + from_sides(size.aside, (0, 90, 180, 270)),
        categories=("coffee box", "food"),
    )


def _cup(page: Colour, ink: Colour) -> Picture:
    canvas = plain(page, 40, 40)
    y, x = np.mgrid[0:40, 0:40].astype(float)
    steam = np.abs(x - 19.5 - 1.5 * np.sin(y * 0.9))
    canvas[((steam < 1) | (np.abs(steam - 6) < 1)) & (y > 3) & (y < 11)] = ink
    half = 10 - np.clip(y - 20, 0, 8) * 0.6
    canvas[(abs(x - 19.5) < half) & (y > 12) & (y < 26)] = ink
    handle = np.hypot(x - 30, y - 17)
    canvas[(handle < 5) & (handle > 2.6)] = ink
    canvas[(abs(x - 19.5) < 13) & (y >= 27) & (y < 29)] = ink
    return to_picture(write(canvas, "COFFEE", 32, ink))


def _bean(page: Colour, ink: Colour) -> Picture:
    canvas = plain(page, 40, 40)
    y, x = np.mgrid[0:40, 0:40] - 19.5
    u, v = 0.8 * x + 0.6 * y, -0.6 * x + 0.8 * y
    canvas[(u / 14) ** 2 + (v / 9) ** 2 < 1] = ink
    canvas[(abs(v - 2.2 * np.sin(u / 4.5)) < 1.1) & (abs(u) < 13.5)] = page
    return to_picture(canvas)


BROWN, CREAM, BLACK = (0.34, 0.20, 0.12), (0.94, 0.88, 0.76), (0.10, 0.09, 0.09)
GOLD, RED, GREEN = (0.82, 0.64, 0.28), (0.70, 0.12, 0.12), (0.12, 0.36, 0.26)
KRAFT, BLUE, WHITE = (0.72, 0.55, 0.36), (0.16, 0.32, 0.60), (0.94, 0.94, 0.93)
ORANGE = (0.90, 0.48, 0.14)

Row = tuple[Packet, Colour, Colour, Label, tuple[str, ...]]
ROWS: tuple[Row, ...] = (
    (
        Packet(0.0740, 0.0962, 0.0660, "bag", 0.0600, 0.0309, 0.250),
        KRAFT,
        BROWN,
        (CREAM, BROWN),
        ("brown coffee bag", "bag of coffee", "paper bag of coffee", "coffee pack"),
    ),
    (
        Packet(0.0776, 0.0696, 0.0728, "tin", 0.0424, 0.0280, 0.210),
        BLACK,
        GOLD,
        (BLACK, GOLD),
        ("black coffee tin", "black and gold coffee box", "coffee tin", "square coffee tin"),
    ),
    (
        Packet(0.0740, 0.0664, 0.0740, "can", 0.0440, 0.0280, 0.190),
        RED,
        GOLD,
        (RED, CREAM),
        ("red coffee can", "round coffee tin", "red coffee tin", "round red coffee box"),
    ),
    (
        Packet(0.0590, 0.0770, 0.0564, "carton", 0.0600, 0.0420, 0.150),
        GREEN,
        CREAM,
        (CREAM, GREEN),
        ("green coffee box", "coffee box", "green coffee carton", "small green coffee box"),
    ),
    (
        Packet(0.0776, 0.0690, 0.0580, "carton", 0.0560, 0.0420, 0.165),
        BROWN,
        ORANGE,
        (ORANGE, BROWN),
        ("brown coffee box", "orange and brown coffee box", "coffee carton", "box of coffee"),
    ),
    (
        Packet(0.0772, 0.0570, 0.0225, "carton", 0.0400, 0.0330, 0.055),
        BLUE,
        WHITE,
        (WHITE, BLUE),
        ("flat coffee box", "blue coffee box", "thin box of coffee", "blue instant coffee box"),
    ),
    (
        Packet(0.0478, 0.0772, 0.0538, "bag", 0.0520, 0.0330, 0.140),
        BLACK,
        RED,
        (RED, WHITE),
        (
            "black coffee bag",
            "small coffee bag",
            "black bag of coffee",
            "coffee with a red label",
        ),
    ),
)

MODELS: Models = {"113_coffee-box": {i: partial(coffee_box, *row) for i, row in enumerate(ROWS)}}
