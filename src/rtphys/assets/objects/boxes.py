"""062_plasticbox, 007_shoe-box and 008_tray: open boxes that hold objects.

The wall grasps of the plastic box sit in the middle of each wall, where its own walls are; the
official ones of some models hang beside it.
"""

from functools import partial

from rtphys.assets.asset_model import Array, AssetModel, Body, Part, contact, functional
from rtphys.assets.labels import label
from rtphys.assets.material import Colour, matt, plastic
from rtphys.assets.objects import Models
from rtphys.assets.pictures import grain
from rtphys.assets.rounded_tray import RoundedTray
from rtphys.assets.words import Words, phrases

Spot = tuple[float, float, float]


def plastic_box(
    size: RoundedTray, mass: float, colour: Colour, spots: tuple[Spot, ...], words: Words
) -> AssetModel:
    """A storage box with a bead around the rim; `spots` are the functional points [m]."""
    shell = plastic(colour, 0.5)
    looks = (Part(size.shell() + size.rim(0.003), shell),)
    return AssetModel(
        body=Body(looks, (*size.parts(), *size.rim_parts(0.003)), mass),
        material="plastic",
        description=phrases(*words, "storage box"),
        contact_points=_walls(size),
        functional_points=tuple(functional(p, (0, 1, 0), (1, 0, 0)) for p in spots),
        categories=("box", "household"),
    )


def _walls(size: RoundedTray) -> tuple[Array, ...]:
    """Grasps from above across the walls at -x, +x, +z, -z, both yaws each."""
    y = size.y - 0.008
    x = 0.5 * size.x - 0.5 * size.wall
    z = 0.5 * size.z - 0.5 * size.wall
    ends = [contact((s * x, y, 0), (0, 1, 0), (0, 0, t)) for s in (-1, 1) for t in (1, -1)]
    flanks = [contact((0, y, s * z), (0, 1, 0), (t, 0, 0)) for s in (1, -1) for t in (-1, 1)]
    return (*ends, *flanks)


def shoe_box(size: RoundedTray, mass: float) -> AssetModel:
    """An open cardboard box, printed outside, with tissue paper on its floor."""
    board = matt((1, 1, 1)).with_picture(label(ORANGE, BLACK, WHITE, "band"), "cylinder")
    looks = (
        Part(size.shell(), board, "cardboard"),
        Part(size.rim(0.0005, 0.004), matt((0.80, 0.68, 0.50)), "cardboard"),
        Part(size.liner(), matt((0.93, 0.93, 0.90)), "paper"),
    )
    return AssetModel(
        body=Body(looks, size.parts(), mass),
        material="cardboard",
        description=phrases("shoe box", "orange", "a black stripe", "cardboard box"),
        functional_points=tuple(
            functional((x, 0.0645, 0), (0, -1, 0), (1, 0, 0)) for x in (0.0423, -0.0423)
        ),
        categories=("shoe box", "household"),
    )


def tray(
    size: RoundedTray, mass: float, colour: Colour, spots: tuple[Spot, Spot], words: Words
) -> AssetModel:
    """A serving tray; its left and right place are functional points 0 and 1."""
    wooden = words[1] == "wooden"
    skin = plastic(colour, 0.4)
    if wooden:
        skin = matt((1, 1, 1)).with_picture(grain(colour, "tray", 0.2), "y")
    sheet = matt((0.90, 0.88, 0.82)) if not wooden else skin
    stuff = "wood" if wooden else "plastic"
    looks = (
        Part(size.shell() + size.rim(0.003, 0.004), skin, stuff),
        Part(size.liner(), sheet, "paper"),
    )
    return AssetModel(
        body=Body(looks, (*size.parts(), *size.rim_parts(0.003, 0.004)), mass),
        material=stuff,
        description=phrases(*words, "serving tray"),
        functional_points=tuple(functional(p, (0, -1, 0), (1, 0, 0)) for p in spots),
        categories=("tray", "kitchen"),
    )


BLUE, GREEN, RED = (0.20, 0.42, 0.78), (0.36, 0.66, 0.42), (0.78, 0.20, 0.18)
WHITE, BLACK, ORANGE = (0.92, 0.92, 0.90), (0.10, 0.10, 0.11), (0.92, 0.44, 0.10)
PINK, GREY, YELLOW = (0.92, 0.62, 0.68), (0.52, 0.55, 0.58), (0.95, 0.78, 0.22)
TEAL, OAK, BROWN = (0.16, 0.56, 0.58), (0.74, 0.55, 0.34), (0.34, 0.20, 0.12)

MODELS: Models = {
    "062_plasticbox": {
        0: partial(
            plastic_box, RoundedTray(0.190, 0.074, 0.148, 0.88, 0.003, 0.003, 0.020, 2), 0.14,
            GREEN, ((0.0360, 0, 0.0114), (-0.0368, 0, -0.0142)),
            ("plastic box", "green", "rounded corners"),
        ),
        1: partial(
            plastic_box, RoundedTray(0.150, 0.070, 0.150, 0.86, 0.003, 0.003, 0.030, 2), 0.12, PINK,
            ((0.0002, 0, -0.0324), (0.0005, 0, 0.0379)),
            ("plastic box", "pink", "a square shape"),
        ),
        2: partial(
            plastic_box, RoundedTray(0.176, 0.111, 0.176, 0.90, 0.003, 0.003, 0.088, 3), 0.20,
            YELLOW, ((-0.0378, 0, -0.0213), (0.0363, 0, 0.0421)),
            ("round plastic box", "yellow", "high walls"),
        ),
        3: partial(
            plastic_box, RoundedTray(0.188, 0.074, 0.152, 0.92, 0.003, 0.003, 0.012), 0.15, BLUE,
            ((0.0329, 0, 0), (-0.0313, 0, 0)),
            ("plastic box", "blue", "steep walls"),
        ),
        4: partial(
            plastic_box, RoundedTray(0.190, 0.093, 0.143, 0.90, 0.003, 0.003, 0.015), 0.17, GREY,
            ((0.0366, 0, 0.0157), (-0.0367, 0, -0.0137)),
            ("deep plastic box", "grey", "high walls"),
        ),
        5: partial(
            plastic_box, RoundedTray(0.190, 0.075, 0.136, 0.94, 0.003, 0.003, 0.025, 2), 0.13,
            ORANGE, ((0.0453, 0, 0.0162), (-0.0221, 0, -0.0090)),
            ("plastic box", "orange", "rounded corners"),
        ),
        6: partial(
            plastic_box, RoundedTray(0.190, 0.082, 0.129, 0.86, 0.003, 0.003, 0.010), 0.14, WHITE,
            ((0.0355, 0, 0), (-0.0434, 0, 0)),
            ("narrow plastic box", "white", "slanting walls"),
        ),
    },
    "007_shoe-box": {
        0: partial(shoe_box, RoundedTray(0.180, 0.1055, 0.260, 1.0, 0.003, 0.004, 0.002), 0.22),
    },
    "008_tray": {
        0: partial(
            tray, RoundedTray(0.301, 0.030, 0.184, 0.92, 0.004, 0.004, 0.015), 0.38, RED,
            ((-0.0745, 0.0049, 0), (0.0738, 0.0049, 0)),
            ("tray", "red", "a paper sheet"),
        ),
        1: partial(
            tray, RoundedTray(0.301, 0.037, 0.188, 0.86, 0.004, 0.004, 0.040, 2), 0.40, TEAL,
            ((-0.0721, 0.0060, 0), (0.0747, 0.0060, 0)),
            ("tray", "teal", "round corners"),
        ),
        2: partial(
            tray, RoundedTray(0.301, 0.037, 0.219, 0.90, 0.007, 0.006, 0.008), 0.62, OAK,
            ((-0.0762, 0.0078, 0), (0.0698, 0.0078, 0)),
            ("tray", "wooden", "thick walls"),
        ),
        3: partial(
            tray, RoundedTray(0.301, 0.040, 0.230, 0.84, 0.004, 0.005, 0.070, 3), 0.45, BROWN,
            ((-0.0689, 0.0078, 0), (0.0633, 0.0078, 0)),
            ("oval tray", "brown", "a paper sheet"),
        ),
    },
}  # fmt: skip
