"""039_mug: mugs with a handle towards -z (away from the robot as they spawn), and their rack.

The origin is below the middle of body and handle together, as in the official models: the body's
axis is at z = `shift`. Official metadata repeats contact points 2 and 3 as 4 and 5; here those are
at the other flank, as in model 0.
"""

from dataclasses import dataclass
from functools import partial

import numpy as np

from rtphys.assets.asset_model import AssetModel, Body, Part, contact, functional
from rtphys.assets.bottle import with_handle
from rtphys.assets.labels import label
from rtphys.assets.material import Colour, Picture, plastic
from rtphys.assets.objects import Models
from rtphys.assets.pictures import bands, stripes
from rtphys.assets.vessel import Vessel
from rtphys.assets.words import Words, phrases

BAR = 0.006  # [m] radius of the handle


@dataclass(frozen=True)
class Mug:
    """Sizes [m]."""

    foot: float  # radius
    belly: float  # radius at its widest
    rim: float  # radius
    height: float
    shift: float  # z of the body's axis
    grip: float  # height of the contact points
    hole: tuple[float, float]  # y, z of the handle hole's middle
    mass: float  # [kg]
    widest: float = 0.5  # share of the height at which it is `belly` wide

    def vessel(self) -> Vessel:
        """The body about its own axis."""
        outer = (
            (self.foot, 0.0),
            (self.belly, self.widest * self.height),
            (self.rim, self.height),
        )
        return Vessel(outer, 0.004, 0.006)


@dataclass(frozen=True)
class Look:
    """Colours of outside, print, inside and handle."""

    outside: Colour
    inside: Colour
    handle: Colour
    picture: Picture | None = None


def mug(size: Mug, look: Look, words: Words) -> AssetModel:
    """A mug of melamine, since a pinched rim cannot carry heavy stoneware."""
    vessel = size.vessel()
    finish = plastic((1, 1, 1) if look.picture is not None else look.outside, 0.7)
    if look.picture is not None:
        finish = finish.with_picture(look.picture, "cylinder")
    # Turned, so that a printed label's badge looks to the side and not at the handle.
    shell = vessel.shell().turned("y", 90).at(z=size.shift)
    looks = (
        Part(shell, finish, "plastic", 50),
        Part(vessel.liner().at(z=size.shift), plastic(look.inside, 0.7), "plastic", 50),
    )
    body = Body(looks, tuple(p.at(z=size.shift) for p in vessel.parts()), size.mass)
    y, z = size.hole
    return AssetModel(
        body=with_handle(body, _handle(size, vessel), plastic(look.handle, 0.7)),
        material="plastic",
        description=phrases(*words, "coffee cup"),
        contact_points=_rim(size, vessel.rim[0]),
        functional_points=(
            functional((0, y, z), (1, 0, 0), (0, 0, -1)),
            functional((0, 0, 0), (0, -1, 0), (1, 0, 0)),
        ),
        categories=("mug", "tableware"),
    )


def _handle(size: Mug, vessel: Vessel) -> list[tuple[float, float, float]]:
    """A bar around the hole's middle; as far out as the body is on the other side."""
    y, z = size.hole
    out = -(size.shift + size.belly) + BAR
    half = min(0.34 * size.height, size.height - 0.012 - y)
    low, high = y - half, y + half
    root = [size.shift - vessel.radius(h) + 0.002 for h in (low, high)]
    bend = 0.45 * (z - out)
    return [
        (0, low, root[0]),
        (0, low + 0.15 * half, z - bend),
        (0, y - 0.45 * half, out),
        (0, y + 0.45 * half, out),
        (0, high - 0.05 * half, z - bend),
        (0, high, root[1]),
    ]


def _rim(size: Mug, radius: float) -> tuple[np.ndarray, ...]:
    """Grasps from above: 0, 1 opposite the handle, 2, 3 at +x, 4, 5 at -x, both yaws each."""
    h, c = size.grip, size.shift
    front = [contact((0, h, c + radius), (0, 1, 0), (s, 0, 0)) for s in (1, -1)]
    sides = [contact((x, h, c), (0, 1, 0), (0, 0, s)) for x in (radius, -radius) for s in (1, -1)]
    return (*front, *sides)


WHITE, CREAM, RED = (0.94, 0.94, 0.92), (0.93, 0.88, 0.76), (0.78, 0.13, 0.11)
BLUE, GREEN, YELLOW = (0.10, 0.30, 0.68), (0.24, 0.52, 0.36), (0.95, 0.77, 0.18)
BLACK, PINK, TEAL = (0.11, 0.11, 0.12), (0.94, 0.62, 0.68), (0.10, 0.52, 0.55)
GREY, BROWN, ORANGE = (0.58, 0.60, 0.62), (0.38, 0.22, 0.13), (0.92, 0.46, 0.12)
SKY, PURPLE = (0.55, 0.76, 0.90), (0.46, 0.30, 0.62)

# Mug: foot, belly, rim, height, shift, grip, hole, mass, widest.
ROWS: tuple[tuple[Mug, Look, Words], ...] = (
    (
        Mug(0.0530, 0.0545, 0.0545, 0.1131, 0.0224, 0.1078, (0.0718, -0.0480), 0.084, 0.1),
        Look(WHITE, WHITE, RED, bands((WHITE, RED, WHITE), (3, 4, 6))),
        ("mug", "white", "a red handle"),
    ),
    (
        Mug(0.0430, 0.0445, 0.0445, 0.0919, 0.0182, 0.0876, (0.0554, -0.0390), 0.06, 0.1),
        Look(BLUE, WHITE, BLUE),
        ("mug", "blue", "a white inside"),
    ),
    (
        Mug(0.0420, 0.0510, 0.0505, 0.1024, 0.0207, 0.0960, (0.0640, -0.0444), 0.072, 0.6),
        Look(GREEN, CREAM, CREAM, bands((CREAM, GREEN), (2, 5))),
        ("mug", "green", "a cream rim"),
    ),
    (
        Mug(0.0340, 0.0376, 0.0370, 0.0769, 0.0200, 0.0723, (0.0423, -0.0300), 0.044, 0.5),
        Look(YELLOW, WHITE, YELLOW, label(YELLOW, WHITE, RED, "badge")),
        ("small mug", "yellow", "a white badge"),
    ),
    (
        Mug(0.0400, 0.0446, 0.0405, 0.0920, 0.0200, 0.0872, (0.0504, -0.0389), 0.06, 0.4),
        Look(BLACK, ORANGE, BLACK),
        ("round mug", "black", "an orange inside"),
    ),
    (
        Mug(0.0560, 0.0596, 0.0596, 0.1241, 0.0176, 0.1191, (0.0663, -0.0552), 0.11, 0.2),
        Look(SKY, WHITE, BLUE, stripes((SKY, WHITE), 8)),
        ("big mug", "light blue", "white stripes"),
    ),
    (
        Mug(0.0380, 0.0440, 0.0390, 0.1090, 0.0162, 0.1074, (0.0619, -0.0377), 0.066, 0.3),
        Look(PINK, WHITE, PINK, label(PINK, RED, WHITE, "fruit")),
        ("tall mug", "pink", "red dots"),
    ),
    (
        Mug(0.0360, 0.0402, 0.0402, 0.0809, 0.0189, 0.0774, (0.0428, -0.0346), 0.05, 0.7),
        Look(GREY, GREY, BROWN, bands((GREY, BROWN, GREY), (4, 1, 4))),
        ("mug", "grey", "a brown stripe"),
    ),
    (
        Mug(0.0420, 0.0464, 0.0430, 0.0929, 0.0190, 0.0891, (0.0489, -0.0402), 0.062, 0.35),
        Look(TEAL, CREAM, TEAL),
        ("pot-bellied mug", "teal", "a cream inside"),
    ),
    (
        Mug(0.0360, 0.0428, 0.0380, 0.1057, 0.0226, 0.1009, (0.0655, -0.0365), 0.064, 0.6),
        Look(PURPLE, WHITE, WHITE, bands((WHITE, PURPLE, WHITE, PURPLE), (1, 4, 1, 4))),
        ("mug", "purple", "white stripes"),
    ),
)  # fmt: skip

MODELS: Models = {"039_mug": {i: partial(mug, *row) for i, row in enumerate(ROWS)}}
