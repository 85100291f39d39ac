"""059_pencup: hollow cups with pens in them."""

from dataclasses import dataclass
from functools import partial

import numpy as np

from rtphys.assets.asset_model import AssetModel, Body, Part
from rtphys.assets.geometry import circle, cone, cylinder, extrude
from rtphys.assets.material import Colour, Finish, matt, plastic
from rtphys.assets.objects import Models
from rtphys.assets.parts import shell_parts, tray_parts
from rtphys.assets.pictures import grain, stripes
from rtphys.assets.solid import Solid

WALL = 0.004  # [m]
INKS = ((0.85, 0.15, 0.12), (0.12, 0.35, 0.78), (0.95, 0.78, 0.15), (0.15, 0.58, 0.32))


@dataclass(frozen=True)
class Cup:
    """Sizes [m]: width, height of the rim, of the longest pen; mass [kg] with pens."""

    width: float
    rim: float
    height: float
    square: bool
    pens: int
    mass: float


def pen_cup(size: Cup, finish: Finish, words: tuple[str, ...]) -> AssetModel:
    """A cup and pens that lean against its rim; they are part of it."""
    half, rim = size.width / 2, size.rim
    if size.square:
        parts = tray_parts(size.width, rim, size.width, WALL)
        cup = parts[0]
        for p in parts[1:]:
            cup = cup + p
    else:
        floor = extrude(circle(half, 20), WALL)
        bore = extrude(circle(half - WALL, 20), rim).at(y=WALL)
        cup = extrude(circle(half, 20), rim) - bore
        wall = shell_parts([(half, 0), (half, rim)], [(half - WALL, 0), (half - WALL, rim)], 10)
        parts = (*wall, floor)
    pens = [_pen(size, i) for i in range(size.pens)]
    looks = [Part(cup, finish, "plastic", 50)]
    for i, (barrel, tip) in enumerate(pens):
        looks.append(Part(barrel + tip, plastic(INKS[i % 4], 0.5), "wood"))
    return AssetModel(
        body=Body(tuple(looks), (*parts, *(s for pen in pens for s in pen)), size.mass),
        material="plastic",
        description=words,
        categories=("pen cup", "office"),
    )


def _pen(size: Cup, i: int) -> tuple[Solid, Solid]:
    """A six sided pen from the floor on one side to the rim on the other."""
    long = size.height * (1 - 0.06 * i) - 0.012
    turn = 360 * i / size.pens + 20
    reach = size.width / 2 - WALL - 0.006
    lean = np.degrees(np.arcsin(min(0.8, 1.25 * reach / size.rim)))
    scale = 1 / np.cos(np.radians(lean))
    length = (long - WALL) * scale - 0.004
    barrel = cylinder(0.004, length - 0.016, 6).at(y=(length - 0.016) / 2)
    tip = cone(0.004, 0.0012, 0.016, 6).at(y=length - 0.016)
    placed = [s.turned("z", -lean).at(-0.6 * reach, WALL + 0.003, 0.1 * reach).turned("y", turn)
              for s in (barrel, tip)]  # fmt: skip
    return placed[0], placed[1]


OAK = matt((0.74, 0.54, 0.34)).with_picture(grain((1.0, 1.0, 1.0), "pen cup", 0.18), "z")
STRIPED = plastic((1, 1, 1), 0.4).with_picture(
    stripes(((0.92, 0.92, 0.90), (0.20, 0.45, 0.70)), 6), "cylinder"
)
GREY: Colour = (0.30, 0.31, 0.34)

MODELS: Models = {
    "059_pencup": {
        2: partial(
            pen_cup,
            Cup(0.075, 0.100, 0.152, False, 4, 0.19),
            plastic(GREY, 0.4),
            ("grey pen cup", "pen cup", "cup with pens", "pencil holder"),
        ),
        3: partial(
            pen_cup,
            Cup(0.070, 0.095, 0.153, False, 3, 0.17),
            STRIPED,
            ("striped pen cup", "blue and white pen cup", "pencil cup", "cup with three pens"),
        ),
        4: partial(
            pen_cup,
            Cup(0.076, 0.105, 0.152, True, 4, 0.26),
            OAK,
            ("wooden pen cup", "square pen holder", "wooden box with pens", "pen box"),
        ),
    },
}
