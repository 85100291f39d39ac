"""041_shoe: shoes along z, toe to +z, sole on the ground, waisted where the fingers close.

Sole and upper are lofts of cross-sections; the collision is a few convex slabs of the upper.
"""

from dataclasses import dataclass
from functools import partial

import numpy as np

from rtphys.assets.asset_model import AssetModel, Body, Part, contact, functional
from rtphys.assets.geometry import box
from rtphys.assets.material import Colour, matt, plastic, tint
from rtphys.assets.objects import Models
from rtphys.assets.solid import Solid, together
from rtphys.assets.swept import dome, loft, slabs

# From heel to toe: place along the shoe, width and height as shares.
LOW = (
    (-0.500, 0.42, 0.60),
    (-0.470, 0.66, 0.88),
    (-0.400, 0.80, 1.00),
    (-0.260, 0.84, 0.93),
    (-0.120, 0.82, 0.84),
    (-0.020, 0.82, 0.83),
    (0.080, 0.82, 0.74),
    (0.200, 0.94, 0.58),
    (0.320, 0.98, 0.46),
    (0.420, 0.84, 0.41),
    (0.475, 0.58, 0.36),
    (0.500, 0.30, 0.26),
)
HIGH = (
    (-0.500, 0.50, 0.50),
    (-0.475, 0.70, 0.96),
    (-0.400, 0.82, 1.00),
    (-0.240, 0.84, 1.00),
    (-0.120, 0.82, 0.97),
    (-0.030, 0.82, 0.78),
    (0.080, 0.82, 0.60),
    (0.200, 0.94, 0.47),
    (0.320, 0.98, 0.38),
    (0.420, 0.84, 0.34),
    (0.475, 0.58, 0.30),
    (0.500, 0.30, 0.22),
)
GRIP = -0.006  # [m] z of the grasps: nearer to the centre of mass than the official 0
STOPS = (0, 2, 4, 6, 8, 11)  # where the convex slabs meet


@dataclass(frozen=True)
class Shoe:
    """Sizes [m], point heights [m] and mass [kg]."""

    width: float
    height: float
    length: float
    grip: float  # y of the grasps
    sole: float  # y of the functional point
    high: bool
    laces: bool
    mass: float


def shoe(
    size: Shoe, upper: Colour, under: Colour, trim: Colour, words: tuple[str, ...]
) -> AssetModel:
    """One shoe. `trim` colours the laces and a stripe on each side."""
    rows = HIGH if size.high else LOW
    w, h, length = size.width, size.height, size.length
    rings = np.array([dome(b * w, c * h, a * length, 11, 3.2) for a, b, c in rows])
    body = loft(rings)
    sole = loft(_sole(rows, w, 0.24 * h * (0.8 if size.high else 1.0), length))
    cloth = matt(upper)
    looks = [
        Part(body, cloth, "fabric", 60),
        Part(sole, plastic(under, 0.2), "rubber", 50),
        Part(_opening(rows, size), matt((0.10, 0.09, 0.09)), "fabric"),
        Part(_stripes(rows, size), plastic(trim, 0.4), "leather"),
    ]
    if size.laces:
        looks.append(Part(_laces(rows, size), plastic(tint(trim, 1.15), 0.3), "fabric"))
    y = (0, 1, 0)
    return AssetModel(
        body=Body(tuple(looks), (*slabs(rings, STOPS), _waist(rows, size)), size.mass),
        material="rubber",
        description=words,
        contact_points=tuple(contact((0, size.grip, GRIP), y, (0, 0, s)) for s in (1, -1)),
        functional_points=(functional((0, size.sole, 0), (0, -1, 0), (1, 0, 0)),),
        categories=("shoe", "clothing"),
    )


def _waist(rows: tuple, size: Shoe) -> Solid:
    """Flat sides for the fingers: on rounded ones they touch at a point, and the heel sinks."""
    low, high = 0.012, 0.5 * _at(rows, 0.0, 2) * size.height
    thick = 0.82 * size.width
    return box(thick, high - low, 0.032).at(0, (low + high) / 2, GRIP)


def _at(rows: tuple, place: float, column: int) -> float:
    return float(np.interp(place, [r[0] for r in rows], [r[column] for r in rows]))


def _sole(rows: tuple, width: float, height: float, length: float) -> np.ndarray:
    """The rim of rubber: a little wider than the upper, lower towards the toe."""
    ends = [(a, b, 1.0 if a < -0.1 else 0.82) for a, b, _ in rows]
    return np.array(
        [dome(1.0 * b * width + 0.002, c * height, a * length * 1.004, 7, 6) for a, b, c in ends]
    )


def _opening(rows: tuple, size: Shoe) -> Solid:
    """The dark inside, as a flat lid on the collar."""
    start, end = (-0.44, -0.14) if size.high else (-0.44, -0.10)
    places = np.linspace(start, end, 7)
    middle, half = (start + end) / 2, (end - start) / 2
    rings = []
    for a in places:
        round_ = max(0.15, 1 - ((a - middle) / half) ** 2) ** 0.5
        wide = 0.74 * round_ * _at(rows, a, 1) * size.width
        ring = dome(wide, 0.012, a * size.length, 6, 4)
        rings.append(ring + np.array([0, _at(rows, a, 2) * size.height - 0.0105, 0]))
    return loft(rings)


def _laces(rows: tuple, size: Shoe) -> Solid:
    """Bars across the instep."""
    start, end = (-0.06, 0.16) if size.high else (-0.04, 0.18)
    bars = []
    for a in np.linspace(start, end, 4):
        slope = (_at(rows, a + 0.04, 2) - _at(rows, a - 0.04, 2)) * size.height
        lean = np.degrees(np.arctan2(-slope, 0.08 * size.length))
        bar = box(0.48 * _at(rows, a, 1) * size.width, 0.004, 0.007).turned("x", lean)
        bars.append(bar.at(0, _at(rows, a, 2) * size.height, a * size.length))
    return together(*bars)


def _stripes(rows: tuple, size: Shoe) -> Solid:
    """Slanted stripes on both flanks, let into the upper."""
    bars = []
    for i, a in enumerate((-0.02, 0.05, 0.12)):
        tall = (0.42 - 0.05 * i) * _at(rows, a, 2) * size.height
        wide = 0.955 * _at(rows, a, 1) * size.width
        bar = box(wide + 0.002, tall, 0.007).turned("x", -24)
        bars.append(bar.at(0, 0.50 * _at(rows, a, 2) * size.height, a * size.length))
    return together(*bars)


WHITE, BLACK, GREY = (0.93, 0.93, 0.92), (0.09, 0.09, 0.10), (0.50, 0.51, 0.54)
RED, BLUE, NAVY = (0.75, 0.10, 0.12), (0.15, 0.40, 0.78), (0.10, 0.14, 0.32)
BROWN, TAN, GREEN = (0.36, 0.20, 0.11), (0.72, 0.53, 0.33), (0.20, 0.50, 0.30)
PINK, YELLOW, CREAM = (0.92, 0.50, 0.62), (0.95, 0.80, 0.15), (0.92, 0.86, 0.74)

Row = tuple[Shoe, Colour, Colour, Colour, tuple[str, ...]]
ROWS: tuple[Row, ...] = (
    (
        Shoe(0.0800, 0.1090, 0.2180, 0.0520, 0.0172, True, True, 0.36),
        RED,
        WHITE,
        WHITE,
        ("red high top sneaker", "red shoe", "high red sneaker", "red shoe with white laces"),
    ),
    (
        Shoe(0.0825, 0.1080, 0.2170, 0.0520, 0.0159, True, True, 0.38),
        BLACK,
        WHITE,
        WHITE,
        ("black high top sneaker", "black shoe", "high black sneaker", "black basketball shoe"),
    ),
    (
        Shoe(0.0780, 0.0860, 0.2130, 0.0404, 0.0121, False, True, 0.28),
        WHITE,
        GREY,
        BLUE,
        ("white sneaker", "white running shoe", "white shoe with blue stripes", "running shoe"),
    ),
    (
        Shoe(0.0810, 0.1220, 0.2200, 0.0560, 0.0179, True, True, 0.52),
        TAN,
        BROWN,
        BROWN,
        ("tan boot", "brown boot", "hiking boot", "boot with brown laces"),
    ),
    (
        Shoe(0.0755, 0.0980, 0.2125, 0.0470, 0.0153, False, True, 0.30),
        BLUE,
        WHITE,
        YELLOW,
        ("blue sneaker", "blue running shoe", "blue shoe with yellow stripes", "sports shoe"),
    ),
    (
        Shoe(0.0735, 0.1010, 0.2155, 0.0490, 0.0155, False, False, 0.31),
        GREEN,
        CREAM,
        CREAM,
        ("green slip-on shoe", "green shoe", "green sneaker", "green shoe without laces"),
    ),
    (
        Shoe(0.0835, 0.0850, 0.2165, 0.0400, 0.0128, False, False, 0.32),
        BROWN,
        BLACK,
        TAN,
        ("brown loafer", "brown leather shoe", "brown shoe", "low brown shoe"),
    ),
    (
        Shoe(0.0770, 0.0900, 0.2160, 0.0419, 0.0126, False, True, 0.27),
        PINK,
        WHITE,
        WHITE,
        ("pink sneaker", "pink shoe", "pink running shoe", "pink shoe with white laces"),
    ),
    (
        Shoe(0.0730, 0.0870, 0.2125, 0.0411, 0.0123, False, True, 0.26),
        GREY,
        BLACK,
        RED,
        ("grey sneaker", "grey shoe", "grey shoe with red stripes", "narrow grey shoe"),
    ),
    (
        Shoe(0.0830, 0.0945, 0.2140, 0.0454, 0.0151, False, True, 0.30),
        NAVY,
        CREAM,
        CREAM,
        ("navy sneaker", "dark blue shoe", "navy shoe with a cream sole", "wide blue shoe"),
    ),
)

MODELS: Models = {"041_shoe": {i: partial(shoe, *row) for i, row in enumerate(ROWS)}}
