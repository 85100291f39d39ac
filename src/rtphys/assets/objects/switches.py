"""056_switch: a plate with one rocker, whose lower half is to be pressed in.

The rocker is bent by the joint's whole range: at q = 0 its upper half lies in the plate's plane and
the lower half stands out, at the upper limit it is the reverse. Its spring is assumed to
hold it in every position. Ranges and press points are the official ones.
"""

from dataclasses import dataclass
from functools import partial

import numpy as np

from rtphys.assets.asset_model import ArticulatedModel, Body, Joint, Part, contact
from rtphys.assets.geometry import box, rounded_box
from rtphys.assets.material import Colour, plastic, tint
from rtphys.assets.objects import Models
from rtphys.assets.solid import Solid
from rtphys.assets.swept import bevelled
from rtphys.assets.urdf import placed, root_joint

INSIDE = 0.005  # [m] how far the hinge lies behind the plate's face


@dataclass(frozen=True)
class Switch:
    """Sizes [m] and range [rad]; the face is at z = `face` in the root's y-up frame."""

    width: float
    height: float
    thick: float  # plate
    back: float  # depth of the box behind the plate, 0 for none
    face: float
    rocker: tuple[float, float]  # width and height
    lower: float  # [rad]
    upper: float  # [rad]
    press: float  # y of the contact point
    light: bool  # a lamp in the rocker


def switch(size: Switch, plate: Colour, rocker: Colour, words: tuple[str, ...]) -> ArticulatedModel:
    """A wall switch."""
    hinge = (0.0, 0.0, size.face - INSIDE)
    swing = np.tan(size.upper)
    out = INSIDE - swing * size.press  # z of the rocker's lower face where it is pressed
    point = contact((0, size.press, out), (0, 0, 1), (0, 1, 0))
    return ArticulatedModel(
        links={
            "base": Body((), ()),
            "link_0": _plate(size, plate),
            "link_1": _rocker(size, rocker),
        },
        joints=(
            root_joint("base", "link_0"),
            Joint(
                "rocker",
                "revolute",
                "link_0",
                "link_1",
                placed(hinge),
                (1.0, 0.0, 0.0),
                (size.lower, size.upper),
                effort=5.0,
                damping=0.02,
            ),
        ),
        material="plastic",
        description=words,
        contact_points=(("link_1", point),),
        balanced=("link_1",),
        categories=("switch", "electronics"),
    )


def _plate(size: Switch, colour: Colour) -> Body:
    """A frame around the rocker and a box behind it."""
    w, h, t = size.width, size.height, size.thick
    rw, rh = size.rocker[0] + 0.003, size.rocker[1] + 0.003
    z = size.face - t / 2
    whole = rounded_box(w, h, t, min(0.004, 0.4 * t), 2).at(z=z)
    frame = whole - box(rw, rh, 2 * t).at(z=z)
    screws = [box(0.005, 0.005, 0.0015).at(0, s * (h / 2 - 0.010), size.face) for s in (-1, 1)]
    looks = [
        Part(frame, plastic(colour, 0.5), "plastic"),
        Part(screws[0] + screws[1], plastic(tint(colour, 0.6), 0.5), "plastic"),
    ]
    side, end = (w - rw) / 2, (h - rh) / 2
    parts: list[Solid] = []
    for s in (-1, 1):
        parts.append(box(side, h, t).at(s * (w - side) / 2, 0, z))
        parts.append(box(rw, end, t).at(0, s * (h - end) / 2, z))
    deep = max(size.back, 0.004)
    shape = (0.80 * w, 0.80 * h) if size.back else (rw + 0.004, rh + 0.004)
    step = 0.004 if size.back else 0.0
    rear = box(*shape, deep).at(z=size.face - t - deep / 2 - step)
    looks.append(Part(rear, plastic(tint(colour, 0.45), 0.3), "plastic"))
    return Body(tuple(looks), (*parts, rear), 0.16 + 4.0 * size.back)


def _rocker(size: Switch, colour: Colour) -> Body:
    """Two leaning halves, seen from the side as a flat V; each is convex."""
    w, h = size.rocker
    half, swing = h / 2, np.tan(size.upper)
    z, deep = INSIDE, INSIDE + 0.003
    upper = bevelled([(z, 0.0), (z, half), (z - deep, half), (z - deep, 0.0)], w, 0.001)
    lower = bevelled(
        [(z, 0.0), (z + half * swing, -half), (z - 0.6 * deep, -half), (z - deep, 0.0)], w, 0.001
    )
    paint = plastic(colour, 0.7)
    looks = [Part(upper + lower, paint, "plastic")]
    mark = box(0.16 * w, 0.004, 0.0012).at(0, 0.62 * half, z)
    lean = -np.degrees(size.upper)
    ring = (
        box(0.14 * w, 0.10 * h, 0.0012)
        .turned("x", -lean)
        .at(0, -0.66 * half, z + 0.66 * half * swing)
    )
    glow = plastic((0.95, 0.25, 0.15), 0.8) if size.light else plastic(tint(colour, 0.5), 0.5)
    looks.append(Part(mark + ring, glow, "plastic"))
    return Body(tuple(looks), (upper, lower), 0.035)


WHITE, IVORY, GREY = (0.93, 0.93, 0.92), (0.92, 0.87, 0.74), (0.55, 0.57, 0.60)
BLACK, SILVER, RED = (0.10, 0.10, 0.11), (0.75, 0.76, 0.78), (0.80, 0.12, 0.10)
BLUE, GREEN, BROWN = (0.18, 0.40, 0.72), (0.20, 0.60, 0.35), (0.42, 0.28, 0.18)

Row = tuple[Switch, Colour, Colour, tuple[str, ...]]
ROWS: tuple[Row, ...] = (
    (
        Switch(0.090, 0.112, 0.009, 0.105, 0.0500, (0.052, 0.066), 0.0, 0.541, -0.0191, False),
        WHITE,
        RED,
        ("switch with a red rocker", "red switch", "wall switch", "white and red light switch"),
    ),
    (
        Switch(0.086, 0.104, 0.010, 0.0, 0.0090, (0.048, 0.070), 0.0, 0.227, -0.0163, False),
        WHITE,
        GREY,
        ("white switch", "light switch", "white wall switch", "switch with a grey rocker"),
    ),
    (
        Switch(0.100, 0.118, 0.010, 0.0, 0.0080, (0.060, 0.084), 0.0, 0.192, -0.0254, False),
        BLACK,
        WHITE,
        ("black and white switch", "black wall switch", "switch", "switch with a white rocker"),
    ),
    (
        Switch(0.120, 0.128, 0.014, 0.022, 0.0150, (0.076, 0.096), 0.0, 0.122, -0.0322, True),
        SILVER,
        BLACK,
        ("large silver switch", "silver wall switch", "wide switch", "switch with a lamp"),
    ),
    (
        Switch(0.088, 0.110, 0.009, 0.090, 0.0460, (0.050, 0.064), -0.031, 0.415, -0.0182, False),
        IVORY,
        BROWN,
        ("ivory switch", "old light switch", "ivory wall switch", "switch with a brown rocker"),
    ),
    (
        Switch(0.094, 0.120, 0.010, 0.0, 0.0090, (0.056, 0.078), 0.0, 0.244, -0.0226, True),
        GREY,
        BLUE,
        ("grey switch", "switch with a blue rocker", "blue light switch", "grey wall switch"),
    ),
    (
        Switch(0.086, 0.106, 0.010, 0.0, 0.0080, (0.044, 0.050), 0.0, 0.384, -0.0130, False),
        WHITE,
        GREEN,
        ("switch with a green rocker", "green switch", "small light switch", "white wall switch"),
    ),
    (
        Switch(0.092, 0.116, 0.010, 0.0, 0.0090, (0.054, 0.062), 0.0, 0.576, -0.0238, False),
        BROWN,
        IVORY,
        ("brown switch", "wooden look switch", "brown wall switch", "switch with an ivory rocker"),
    ),
)

MODELS: Models = {"056_switch": {i: partial(switch, *row) for i, row in enumerate(ROWS)}}
