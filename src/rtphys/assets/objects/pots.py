"""060_kitchenpot: pots with two handles and a lid that lifts a little.

Links as in the official models: y up, x towards the handles; a fixed joint stands them up in the
z-up root. The lid slides up its travel and falls back by its weight. The fingers close on the
outer bar of a handle from above and below.
"""

from dataclasses import dataclass
from functools import partial

import numpy as np

from rtphys.assets.asset_model import Array, ArticulatedModel, Body, Joint, Part, contact
from rtphys.assets.geometry import ball, box, cylinder, lathe, rounded_box
from rtphys.assets.material import Colour, metal, plastic
from rtphys.assets.objects import Models
from rtphys.assets.solid import Solid
from rtphys.assets.urdf import placed, root_joint
from rtphys.assets.vessel import Vessel, band
from rtphys.assets.words import Words, phrases

BAR = (0.014, 0.010, 0.066)  # [m] a handle's outer bar: along the approach, thick, wide
INSET = 0.010  # [m] from the contact point to the bar's middle
GAP = 0.0005  # [m] between lid and rim


@dataclass(frozen=True)
class Pot:
    """Sizes [m]; heights are counted from the ground."""

    root: float  # height of the root frame
    radius: float
    rim: float  # height of the body
    grip: float  # height of the contact points
    reach: float  # |x| of the contact points
    tilt_deg: float  # by which the approach is steeper than level
    travel: float  # of the lid
    mass: float  # [kg], of which the lid is a quarter
    belly: float = 1.0  # the foot's share of the radius


def pot(size: Pot, shell: Colour, lid: Colour, knob: Colour, words: Words) -> ArticulatedModel:
    """One pot with its lid on."""
    return ArticulatedModel(
        links={
            "base": Body((), ()),
            "link_1": _body(size, shell, knob),
            "link_2": _lid(size, lid, knob),
        },
        joints=(
            root_joint("base", "link_1"),
            Joint(
                "lid",
                "prismatic",
                "link_1",
                "link_2",
                placed((0, size.rim + GAP - size.root, 0)),
                (0.0, 1.0, 0.0),
                (0.0, size.travel),
                damping=1.0,
            ),
        ),
        material="steel",
        description=phrases(*words, "cooking pot"),
        root_height=size.root,
        contact_points=tuple(("link_1", _grip(size, side)) for side in (-1, 1)),
        categories=("pot", "kitchen"),
    )


def _grip(size: Pot, side: int) -> Array:
    t = np.deg2rad(size.tilt_deg)
    p = (side * size.reach, size.grip - size.root, 0)
    return contact(p, (side * np.cos(t), np.sin(t), 0), (0, 0, -1))


def _body(size: Pot, shell: Colour, handle: Colour) -> Body:
    r, h = size.radius, size.rim
    vessel = Vessel(((size.belly * r, 0.0), (r, 0.3 * h), (r, h)), 0.003, 0.005)
    handles = [part for side in (-1, 1) for part in _handle(size, side, False)]
    seen = [part for side in (-1, 1) for part in _handle(size, side, True)]
    grips = seen[0]
    for part in seen[1:]:
        grips = grips + part
    looks = (
        Part(vessel.shell().at(y=-size.root), metal(shell, 0.3), "steel", 50),
        Part(band(vessel.outer, h - 0.008, h - 0.001).at(y=-size.root), metal(STEEL), "steel"),
        Part(grips, plastic(handle, 0.3), "plastic"),
    )
    walls = [p.at(y=-size.root) for p in vessel.parts()]
    return Body(looks, (*walls, *handles), 0.75 * size.mass)


def _handle(size: Pot, side: int, soft: bool) -> list[Solid]:
    """Outer bar and two struts, in the plane of the approach."""
    t = np.deg2rad(size.tilt_deg)
    long = (size.reach - 0.985 * size.radius) / np.cos(t) - INSET
    shapes = [rounded_box(*BAR, 0.004, 1) if soft else box(*BAR)]
    shapes += [
        box(long, 0.009, 0.012).at(-0.5 * long, 0, s * 0.5 * (BAR[2] - 0.013)) for s in (-1, 1)
    ]
    out = size.reach - INSET * np.cos(t)
    up = size.grip - size.root - INSET * np.sin(t)
    turned = [shape.turned("z", size.tilt_deg) for shape in shapes]
    if side < 0:
        turned = [shape.scaled(-1, 1, 1) for shape in turned]
    return [shape.at(side * out, up) for shape in turned]


def _lid(size: Pot, colour: Colour, knob: Colour) -> Body:
    r = size.radius
    outline = [(0, 0), (r, 0), (r, 0.003), (0.55 * r, 0.011), (0, 0.013)]
    dome = lathe(outline, 24)
    stem = cylinder(0.006, 0.012, 10).at(y=0.017)
    handle = ball(0.013, 12).scaled(1, 0.75, 1).at(y=0.028)
    looks = (
        Part(dome, metal(colour, 0.25), "steel", 50),
        Part(stem + handle, plastic(knob, 0.4), "plastic"),
    )
    return Body(looks, (lathe(outline, 16), stem, handle), 0.25 * size.mass)


STEEL, COPPER, RED = (0.74, 0.75, 0.78), (0.78, 0.48, 0.32), (0.75, 0.14, 0.12)
BLUE, BLACK, WHITE = (0.16, 0.34, 0.62), (0.12, 0.12, 0.13), (0.90, 0.89, 0.86)
GREEN, GLASS, BROWN = (0.28, 0.46, 0.36), (0.62, 0.70, 0.74), (0.36, 0.22, 0.13)
YELLOW = (0.93, 0.74, 0.20)

# Pot: root, radius, rim, grip, reach, tilt, travel, mass, belly.
ROWS: tuple[tuple[Pot, Colour, Colour, Colour, Words], ...] = (
    (
        Pot(0.0391, 0.0735, 0.075, 0.0823, 0.1134, 30, 0.0072, 0.70),
        STEEL, STEEL, BLACK, ("kitchen pot", "silver", "slanting handles"),
    ),
    (
        Pot(0.0546, 0.0790, 0.082, 0.0636, 0.1204, 30, 0.0072, 0.85),
        RED, RED, BLACK, ("kitchen pot", "red", "black handles"),
    ),
    (
        Pot(0.0549, 0.0770, 0.100, 0.0893, 0.1150, 0, 0.0040, 0.90, 0.92),
        BLUE, GLASS, BLACK, ("kitchen pot", "blue", "a glass lid"),
    ),
    (
        Pot(0.0656, 0.0820, 0.108, 0.0884, 0.1200, 0, 0.0050, 0.95),
        COPPER, COPPER, BROWN, ("kitchen pot", "copper", "brown handles"),
    ),
    (
        Pot(0.0564, 0.0850, 0.090, 0.0838, 0.1222, 14, 0.0030, 0.95, 0.82),
        WHITE, WHITE, BLUE, ("enamel pot", "white", "blue handles"),
    ),
    (
        Pot(0.0688, 0.0770, 0.122, 0.1050, 0.1117, 0, 0.0012, 1.00),
        GREEN, GREEN, BROWN, ("tall pot", "green", "brown handles"),
    ),
    (
        Pot(0.0784, 0.0880, 0.132, 0.1241, 0.1272, 40, 0.0084, 1.20, 0.95),
        YELLOW, STEEL, BLACK, ("stock pot", "yellow", "a steel lid"),
    ),
)  # fmt: skip

MODELS: Models = {"060_kitchenpot": {i: partial(pot, *row) for i, row in enumerate(ROWS)}}
