"""024_scanner: bar code readers lying as an arch on nose and handle; the red window is below.

+z is ahead. The beam of functional point 0 is square to the window, which looks down and a little
ahead; the grasp is on the back of the arch.
"""

from dataclasses import dataclass
from functools import partial

import numpy as np
from numpy.typing import NDArray

from rtphys.assets.asset_model import AssetModel, Body, Part, contact, functional
from rtphys.assets.geometry import box
from rtphys.assets.material import Colour, Picture, plastic, tint
from rtphys.assets.objects import Models
from rtphys.assets.pictures import plain, to_picture
from rtphys.assets.solid import Solid, hull
from rtphys.assets.swept import bevelled

Array = NDArray[np.float64]
WINDOW = 0.034  # [m] length of the window


@dataclass(frozen=True)
class Scanner:
    """Sizes [m], tilt of the beam and mass [kg]."""

    head: float  # width
    grip: float  # width
    top: float  # height of the back
    tail: float  # z of the handle's end, negative
    beam_deg: float  # [deg] from straight down towards +z
    nose: float  # z of the window's middle
    hold: tuple[float, float]  # y, z of the contact point
    mass: float


def scanner(size: Scanner, body: Colour, cover: Colour, words: tuple[str, ...]) -> AssetModel:
    """A hand scanner of three convex pieces: head, back and handle."""
    a = np.radians(size.beam_deg)
    along, out = np.array([np.cos(a), np.sin(a)]), np.array([np.sin(a), -np.cos(a)])  # (z, y)
    middle = np.array([size.nose, WINDOW / 2 * np.sin(a)])
    nose = _nose(middle, along, out)
    pieces = _pieces(size, nose, out)
    rim = bevelled(nose + (nose - nose.mean(0)) * 0.05, 1.03 * size.head, 0.003)
    trigger = hull([
        *box(0.012, 0.004, 0.020).at(0, 0.040, 0.010).vertices,
        *box(0.012, 0.004, 0.010).at(0, 0.031, 0.014).vertices,
    ])  # fmt: skip
    plug = box(0.012, 0.010, 0.008).at(0, 0.014, size.tail + 0.001)
    code = plastic((1, 1, 1), 0.4).with_picture(_bars(), "y")
    looks = (
        Part(pieces[0] + pieces[1] + pieces[2], plastic(body, 0.5), "plastic"),
        Part(rim, plastic(cover, 0.6), "rubber"),
        Part(_lid(size), code, "paper"),
        Part(_ray(size, middle, out), plastic((1.0, 0.15, 0.15), 0.9), "plastic"),
        Part(_glass(size, nose, along, out), plastic((0.85, 0.08, 0.10), 0.9), "plastic"),
        Part(trigger + plug, plastic(tint(cover, 0.8), 0.4), "plastic"),
    )
    y, z = size.hold
    beam, up = (0, out[1], out[0]), (0, -along[1], -along[0])
    ahead = functional((0, 0.050, 0.0498), (0, 0, 1), (1, 0, 0))
    return AssetModel(
        body=Body(looks, (*pieces, rim, trigger), size.mass),
        material="plastic",
        description=words,
        contact_points=(contact((0, y, z), (0, 1, 0), (0, 0, 1)),),
        functional_points=(functional((0, middle[1], middle[0]), beam, up), ahead),
        categories=("scanner", "shop"),
    )


def _nose(middle: Array, along: Array, out: Array) -> Array:
    """Outline (z, y) about the window: its rear and front edge, and the two above them."""
    rear, front = middle - along * WINDOW / 2, middle + along * WINDOW / 2
    return np.array([rear, front, front - out * 0.016 + [0.002, 0], rear - out * 0.016])


def _pieces(size: Scanner, nose: Array, out: Array) -> tuple[Solid, Solid, Solid]:
    """Head, back and handle. Convex."""
    top, tail = size.top, size.tail
    rear, front, brow, _ = nose
    head = np.array([brow, (front[0] - 0.008, 0.80 * top), (0.030, top), (0.010, 0.92 * top),
                     (rear[0] - 0.020, 0.045), rear - out * 0.012])  # fmt: skip
    back = [(0.034, top), (-0.030, 0.94 * top), (-0.034, 0.045), (0.0, 0.038), (0.030, 0.040)]
    handle = [(-0.022, 0.94 * top), (-0.010, 0.042), (tail + 0.024, 0.0), (tail + 0.002, 0.0)]
    handle += [(tail, 0.012), (tail + 0.014, 0.048)]
    return (
        _flared(head, 0.74 * size.head, nose, size.head),
        bevelled(back, size.grip + 0.004, 0.006),
        bevelled(handle, size.grip, 0.006),
    )


def _glass(size: Scanner, nose: Array, along: Array, out: Array) -> Solid:
    rear, front = nose[0] + along * 0.003, nose[1] - along * 0.003
    pane = np.array([rear, front, front - out * 0.002, rear - out * 0.002]) + out * 0.0006
    return bevelled(pane, 0.72 * size.head, 0.0004)


def _lid(size: Scanner) -> Solid:
    """A plate on the back that carries the bar code."""
    high, low = size.top + 0.001, 0.94 * size.top + 0.001
    side = [(0.028, high - 0.007), (0.028, high), (-0.026, low), (-0.026, low - 0.005)]
    return bevelled(side, 0.72 * size.grip, 0.001)


def _flared(upper: Array, narrow: float, nose: Array, wide: float) -> Solid:
    """The head: `upper` (z, y) narrow and bevelled, widening to the nose. Convex."""
    top = bevelled(upper, narrow, 0.006)
    low = bevelled(nose, 0.98 * wide, 0.004)
    return hull([*top.vertices, *low.vertices])


def _ray(size: Scanner, middle: Array, out: Array) -> Solid:
    """A red lens across the brow, so that the front is known from above."""
    lens = box(0.62 * size.head, 0.010, 0.006)
    z, y = middle + np.array([np.cos(np.radians(size.beam_deg)), 0]) * WINDOW / 2 - out * 0.010
    return lens.at(0, float(y), float(z) + 0.0015)


def _bars() -> Picture:
    """A bar code, its bars along z."""
    widths = (2, 1, 1, 3, 1, 2, 2, 1, 3, 1, 1, 2, 1, 3, 2, 1, 1, 2, 1, 1)
    ink = np.repeat(np.arange(len(widths)) % 2, widths)
    canvas = plain((0.96, 0.96, 0.94), len(ink) + 4, 40)
    canvas[3:32, 2:-2][:, ink == 0] = (0.05, 0.05, 0.06)
    return to_picture(canvas)


BLACK, GREY, WHITE = (0.12, 0.12, 0.13), (0.45, 0.47, 0.50), (0.90, 0.90, 0.89)
YELLOW, BLUE, RED = (0.95, 0.76, 0.12), (0.15, 0.38, 0.75), (0.78, 0.16, 0.14)
ORANGE, GREEN = (0.92, 0.46, 0.12), (0.25, 0.58, 0.38)

Row = tuple[Scanner, Colour, Colour, tuple[str, ...]]
ROWS: tuple[Row, ...] = (
    (
        Scanner(0.0660, 0.036, 0.0840, -0.0800, 15.7, 0.0611, (0.0487, -0.0116), 0.165),
        BLACK,
        YELLOW,
        ("black and yellow scanner", "barcode scanner", "hand scanner", "scanner"),
    ),
    (
        Scanner(0.0560, 0.034, 0.0830, -0.0780, 30.7, 0.0611, (0.0487, -0.0116), 0.150),
        WHITE,
        BLUE,
        ("white barcode scanner", "white and blue scanner", "white scanner", "code reader"),
    ),
    (
        Scanner(0.0570, 0.038, 0.0755, -0.0790, 11.0, 0.0611, (0.0450, -0.0160), 0.155),
        GREY,
        ORANGE,
        ("grey barcode scanner", "grey and orange scanner", "grey scanner", "flat scanner"),
    ),
    (
        Scanner(0.0535, 0.033, 0.0990, -0.0800, 38.5, 0.0637, (0.0520, -0.0116), 0.170),
        RED,
        BLACK,
        ("red barcode scanner", "red and black scanner", "tall scanner", "red scanner"),
    ),
    (
        Scanner(0.0565, 0.037, 0.0830, -0.0860, 35.6, 0.0603, (0.0487, -0.0116), 0.160),
        BLUE,
        GREEN,
        ("blue barcode scanner", "blue and green scanner", "long scanner", "blue scanner"),
    ),
)

MODELS: Models = {"024_scanner": {i: partial(scanner, *row) for i, row in enumerate(ROWS)}}
