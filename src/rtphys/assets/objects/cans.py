"""071_can and 105_sauce-can: tins and drink cans.

Widths are what the gripper closes around, 6 to 8 cm; the official boxes of the wider ones are not
the width of the tin. Masses are those of partly used cans.
"""

from dataclasses import dataclass
from functools import partial

from rtphys.assets.asset_model import Array, AssetModel, Body, Part, from_above, from_sides
from rtphys.assets.labels import label
from rtphys.assets.material import Colour, metal, plastic
from rtphys.assets.objects import Models
from rtphys.assets.turned import disc, ring, turned, turned_parts
from rtphys.assets.words import Words, phrases

EIGHT = tuple(range(0, 360, 45))
STEEL = (0.74, 0.75, 0.78)


@dataclass(frozen=True)
class Can:
    """Sizes [m]; radii are half widths."""

    radius: float
    height: float
    mass: float  # [kg]
    necked: bool = False  # a drink can: narrow at both ends, with a tab
    lid: Colour = STEEL


@dataclass(frozen=True)
class Print:
    """The label's three colours and its style."""

    ground: Colour
    accent: Colour
    ink: Colour
    style: str


def can(size: Can, look: Print, words: Words, grips: tuple[Array, ...]) -> AssetModel:
    """A tin with a printed sleeve."""
    r, h = size.radius, size.height
    in_, up = (0.84 * r, 0.10 * h) if size.necked else (0.97 * r, 0.02 * h)
    outline = [(0, 0), (in_, 0), (r, up), (r, h - up), (in_, h), (0, h)]
    bare = metal(size.lid, 0.3)
    paper = plastic((1, 1, 1), 0.6 if size.necked else 0.3).with_picture(
        label(look.ground, look.accent, look.ink, look.style), "cylinder"
    )
    looks = [
        Part(turned(outline), bare, "aluminium"),
        Part(ring(r + 0.0005, up + 0.002, h - up - 0.002), paper, "paper"),
    ]
    rim = ring(in_, h - 0.001, h + 0.0012, 0.003)
    tab = disc(0.010, h, h + 0.0015).scaled(0.6, 1, 1).at(z=0.006)
    looks.append(Part(rim + tab if size.necked else rim, bare, "aluminium"))
    return AssetModel(
        body=Body(tuple(looks), turned_parts(outline), size.mass),
        material="aluminium",
        description=phrases(*words, "can"),
        contact_points=grips,
        categories=("can", "drink" if size.necked else "food"),
    )


def _can(size: Can, look: Print, words: Words, top: float) -> AssetModel:
    """A can with the grasps of 071: from the sides at 5.2 cm, from above at `top` [m]."""
    sides = from_sides(0.0521, (270, 315, 0, 45, 90, 135, 180, 225))
    return can(size, look, words, sides + from_above((0, top, 0), EIGHT))


def _sauce(size: Can, look: Print, words: Words, top: float) -> AssetModel:
    """A can with the grasps of 105."""
    sides = from_sides(0.0673, (180, 323, 8, 53, 98, 143, 188, 233))
    if top < 0.0885:  # model 0 is held lower
        sides = from_sides(0.0501, (278, 323, 8, 53, 98, 143, 188, 233))
    return can(size, look, words, sides + from_above((0, top, 0), EIGHT))


WHITE, RED, BLACK = (0.95, 0.95, 0.93), (0.80, 0.10, 0.10), (0.08, 0.08, 0.09)
CREAM = (0.97, 0.90, 0.70)
BLUE, GREEN, YELLOW = (0.10, 0.30, 0.75), (0.13, 0.48, 0.20), (0.97, 0.80, 0.12)
ORANGE, BROWN, GOLD = (0.95, 0.50, 0.10), (0.38, 0.20, 0.10), (0.82, 0.66, 0.28)
NAVY, PINK, OLIVE = (0.08, 0.14, 0.38), (0.95, 0.55, 0.60), (0.45, 0.48, 0.15)

CANS: dict[int, tuple[Can, Print, Words, float]] = {
    0: (
        Can(0.0330, 0.0965, 0.18, True),
        Print(RED, WHITE, RED, "wave"),
        ("soda can", "red", "a white wave"),
        0.0689,
    ),
    1: (
        Can(0.0310, 0.0965, 0.15, True),
        Print(GREEN, YELLOW, WHITE, "badge"),
        ("lemonade can", "green", "a yellow oval"),
        0.0711,
    ),
    2: (
        Can(0.0350, 0.0964, 0.22),
        Print(WHITE, RED, GREEN, "fruit"),
        ("tomato can", "white", "red tomatoes"),
        0.0714,
    ),
    3: (
        Can(0.0385, 0.0968, 0.26),
        Print(BROWN, GOLD, CREAM, "band"),
        ("coffee tin", "brown", "a golden band"),
        0.0734,
    ),
    5: (
        Can(0.0345, 0.0961, 0.21),
        Print(BLUE, YELLOW, WHITE, "blocks"),
        ("corn can", "blue", "a yellow headline"),
        0.0704,
    ),
    6: (
        Can(0.0310, 0.0967, 0.16, True),
        Print(BLACK, ORANGE, WHITE, "band"),
        ("energy drink can", "black", "an orange band"),
        0.0728,
    ),
}

SAUCES: dict[int, tuple[Can, Print, Words, float]] = {
    0: (
        Can(0.0365, 0.1160, 0.27, lid=RED),
        Print(CREAM, RED, RED, "fruit"),
        ("tomato sauce can", "cream", "a red lid"),
        0.0883,
    ),
    2: (
        Can(0.0395, 0.1160, 0.31, lid=GOLD),
        Print(OLIVE, CREAM, BROWN, "badge"),
        ("bean sauce can", "olive green", "a golden lid"),
        0.0891,
    ),
    4: (
        Can(0.0380, 0.1155, 0.29, lid=BLACK),
        Print(NAVY, WHITE, RED, "wave"),
        ("oyster sauce can", "dark blue", "a black lid"),
        0.0897,
    ),
    5: (
        Can(0.0335, 0.1155, 0.24, lid=WHITE),
        Print(ORANGE, YELLOW, RED, "blocks"),
        ("curry sauce can", "orange", "a white lid"),
        0.0891,
    ),
    6: (
        Can(0.0355, 0.1160, 0.26, lid=GREEN),
        Print(PINK, WHITE, RED, "band"),
        ("chilli sauce can", "pink", "a green lid"),
        0.0889,
    ),
}

MODELS: Models = {
    "071_can": {i: partial(_can, *row) for i, row in CANS.items()},
    "105_sauce-can": {i: partial(_sauce, *row) for i, row in SAUCES.items()},
}
