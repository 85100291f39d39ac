"""001_bottle: twenty drink and kitchen bottles.

Bodies are 6 to 8 cm wide where the gripper closes (official boxes of up to 15 cm are not the width
of the glass). Masses are those of partly filled bottles. Models 3, 10 and 11 have eight
contact points where the official ones have the first four.
"""

from collections.abc import Sequence
from functools import partial

from rtphys.assets.asset_model import AssetModel, from_sides, functional
from rtphys.assets.bottle import Bottle, Look, bottle_body, with_handle
from rtphys.assets.objects import Models
from rtphys.assets.words import Words, phrases

AZIMUTHS = (270, 0, 90, 180, 315, 45, 135, 225)  # official order

# What a row says: noun, colour, feature, and the heights [m] of contact and functional points.
Points = tuple[float, float]


def bottle(
    size: Bottle,
    look: Look,
    words: Words,
    points: Points,
    handle: Sequence[tuple[float, float, float]] = (),
) -> AssetModel:
    """A bottle that stands on the origin; `handle` is the path of a jug's handle."""
    body = bottle_body(size, look)
    return AssetModel(
        body=with_handle(body, handle) if handle else body,
        material=look.material,
        description=phrases(*words, "bottle"),
        contact_points=from_sides(points[0], AZIMUTHS),
        functional_points=(functional((0, points[1], 0), (0, -1, 0), (1, 0, 0)),),
        categories=("bottle", "drink"),
    )


WATER, CLEAR, COLA = (0.62, 0.80, 0.90), (0.80, 0.88, 0.92), (0.16, 0.07, 0.05)
WHITE, BLACK, RED = (0.95, 0.95, 0.93), (0.08, 0.08, 0.09), (0.80, 0.10, 0.10)
BLUE, GREEN, YELLOW = (0.10, 0.30, 0.75), (0.10, 0.50, 0.20), (0.97, 0.80, 0.12)
ORANGE, PURPLE, PINK = (0.97, 0.52, 0.10), (0.42, 0.16, 0.50), (0.95, 0.60, 0.70)
WINE, AMBER, SILVER = (0.10, 0.22, 0.12), (0.45, 0.22, 0.06), (0.75, 0.76, 0.78)
TEAL, CREAM, LIME = (0.10, 0.60, 0.60), (0.97, 0.92, 0.78), (0.60, 0.80, 0.15)
GOLD, BROWN, NAVY = (0.80, 0.62, 0.22), (0.40, 0.22, 0.12), (0.08, 0.14, 0.38)
SKY, HONEY, OIL = (0.30, 0.60, 0.90), (0.60, 0.32, 0.08), (0.75, 0.62, 0.15)
CLARET = (0.60, 0.10, 0.16)

# Bottle: height, radius, shoulder, collar, neck, label, mass, waist, foot, top, filled.
ROWS: tuple[tuple[Bottle, Look, Words, Points], ...] = (
    (
        Bottle(0.2545, 0.034, 0.173, 0.219, 0.0125, (0.10, 0.15), 0.16, filled=0.160),
        Look(CLEAR, WATER, BLUE, WHITE, BLUE, WHITE, "wave"),
        ("water bottle", "clear", "a blue cap"),
        (0.1252, 0.1252),
    ),
    (
        Bottle(0.2545, 0.033, 0.173, 0.219, 0.0125, (0.105, 0.146), 0.22, 0.92, grip=0.1255),
        Look(COLA, COLA, RED, RED, WHITE, BLACK, "wave"),
        ("cola bottle", "dark brown", "a red label"),
        (0.1255, 0.1255),
    ),
    (
        Bottle(0.2400, 0.036, 0.170, 0.195, 0.0190, (0.05, 0.15), 0.25, top="wide"),
        Look(ORANGE, ORANGE, WHITE, CREAM, ORANGE, GREEN, "fruit"),
        ("orange juice bottle", "orange", "a white lid"),
        (0.1329, 0.1179),
    ),
    (
        Bottle(0.2550, 0.030, 0.185, 0.210, 0.0200, (0.06, 0.10), 0.12, top="sport"),
        Look(BLUE, BLUE, BLACK, YELLOW, BLACK, YELLOW, "band"),
        ("sports bottle", "blue", "a black nozzle"),
        (0.1253, 0.1253),
    ),
    (
        Bottle(0.2410, 0.0345, 0.168, 0.205, 0.0200, (0.045, 0.12), 0.20, foot=0.8, top="flip"),
        Look(RED, RED, WHITE, WHITE, RED, GREEN, "badge"),
        ("ketchup bottle", "red", "a white flip cap"),
        (0.1451, 0.1187),
    ),
    (
        Bottle(0.2545, 0.033, 0.150, 0.185, 0.0125, (0.05, 0.13), 0.46, top="cork"),
        Look(WINE, WINE, RED, CREAM, CLARET, BLACK, "blocks", "glass"),
        ("wine bottle", "dark green", "a cream label"),
        (0.1123, 0.1255),
    ),
    (
        Bottle(
            0.2545, 0.0355, 0.173, 0.219, 0.0125, (0.112, 0.139), 0.18, 0.88,
            grip=0.1253, filled=0.170,
        ),
        Look(CLEAR, LIME, GREEN, GREEN, YELLOW, WHITE, "badge"),
        ("lemonade bottle", "light green", "a green label"),
        (0.1253, 0.1253),
    ),
    (
        Bottle(0.2550, 0.039, 0.190, 0.222, 0.0210, (0.06, 0.16), 0.28, top="wide"),
        Look(WHITE, WHITE, BLUE, WHITE, BLUE, SKY, "wave"),
        ("milk bottle", "white", "a blue lid"),
        (0.1254, 0.1254),
    ),
    (
        Bottle(0.1860, 0.0335, 0.105, 0.140, 0.0125, (0.045, 0.095), 0.30, top="crown"),
        Look(AMBER, AMBER, GOLD, GOLD, WHITE, BROWN, "badge", "glass"),
        ("beer bottle", "brown", "a golden label"),
        (0.0719, 0.0919),
    ),
    (
        Bottle(
            0.2060, 0.030, 0.150, 0.172, 0.0180, (0.03, 0.085), 0.15, top="wide", filled=0.14
        ),
        Look(CLEAR, PINK, PINK, WHITE, PINK, RED, "fruit"),
        ("strawberry drink bottle", "pink", "a pink lid"),
        (0.1212, 0.1014),
    ),
    (
        Bottle(0.2545, 0.032, 0.200, 0.215, 0.0240, (0.0, 0.0), 0.26, foot=0.95, top="wide"),
        Look(SILVER, SILVER, BLACK, WHITE, WHITE, WHITE, material="steel"),
        ("steel bottle", "silver", "a black lid"),
        (0.1252, 0.1252),
    ),
    (
        Bottle(0.2600, 0.031, 0.170, 0.235, 0.0125, (0.05, 0.11), 0.14),
        Look(OIL, YELLOW, GREEN, GREEN, YELLOW, CREAM, "blocks"),
        ("cooking oil bottle", "yellow", "a green cap"),
        (0.1277, 0.1277),
    ),
    (
        Bottle(0.2545, 0.035, 0.173, 0.219, 0.0125, (0.11, 0.14), 0.20, 0.90, grip=0.1252),
        Look(ORANGE, ORANGE, BLUE, BLUE, ORANGE, WHITE, "band"),
        ("orange soda bottle", "orange", "a blue label"),
        (0.1252, 0.1252),
    ),
    (
        Bottle(0.2475, 0.033, 0.165, 0.205, 0.0125, (0.085, 0.155), 0.17),
        Look(GREEN, GREEN, WHITE, WHITE, GREEN, GREEN, "wave"),
        ("green soda bottle", "bright green", "a white cap"),
        (0.1219, 0.1219),
    ),
    (
        Bottle(0.2315, 0.036, 0.155, 0.175, 0.0160, (0.04, 0.14), 0.24, top="pump"),
        Look(TEAL, TEAL, WHITE, WHITE, TEAL, NAVY, "badge"),
        ("soap dispenser", "teal", "a white pump"),
        (0.1141, 0.1141),
    ),
    (
        Bottle(0.2550, 0.034, 0.180, 0.215, 0.0200, (0.06, 0.13), 0.19, foot=0.75, top="flip"),
        Look(YELLOW, YELLOW, RED, YELLOW, RED, WHITE, "badge"),
        ("mustard bottle", "yellow", "a red cap"),
        (0.1519, 0.1255),
    ),
    (
        Bottle(0.2545, 0.035, 0.175, 0.220, 0.0125, (0.11, 0.142), 0.19, 0.94, grip=0.1259),
        Look(PURPLE, PURPLE, YELLOW, YELLOW, PURPLE, WHITE, "fruit"),
        ("grape soda bottle", "purple", "a yellow cap"),
        (0.1259, 0.1259),
    ),
    (
        Bottle(0.2500, 0.0375, 0.175, 0.205, 0.0210, (0.05, 0.10), 0.23, top="sport"),
        Look(PINK, PINK, WHITE, WHITE, PURPLE, PINK, "wave"),
        ("drinking bottle", "pink", "a white nozzle"),
        (0.1230, 0.1230),
    ),
    (
        Bottle(0.1930, 0.038, 0.125, 0.150, 0.0170, (0.03, 0.10), 0.34, top="wide"),
        Look(HONEY, AMBER, GOLD, WHITE, AMBER, GOLD, "blocks", "glass"),
        ("syrup bottle", "amber", "a golden lid"),
        (0.1049, 0.0949),
    ),
)  # fmt: skip

# The official model 19 has a handle behind; so the foot is wide and the grip is on a waist.
JUG = partial(
    bottle,
    Bottle(
        0.2150, 0.0458, 0.145, 0.175, 0.0200, (0.02, 0.068), 0.32, 0.80,
        foot=0.96, grip=0.1076, top="wide",
    ),
    Look(NAVY, NAVY, ORANGE, WHITE, ORANGE, NAVY, "wave"),
    ("detergent jug", "dark blue", "a handle"),
    (0.1076, 0.1076),
    ((0, 0.141, -0.037), (0, 0.149, -0.064), (0, 0.187, -0.057), (0, 0.191, -0.012)),
)  # fmt: skip

MODELS: Models = {
    "001_bottle": {**{i: partial(bottle, *row) for i, row in enumerate(ROWS)}, 19: JUG},
}
