"""070_paymentsign: boards that lean back and show a pay code to +z only; the back is blank.

The board leans as the official points say; the grasps are 1 cm below its upper edge.
"""

from dataclasses import dataclass
from functools import partial

import numpy as np

from rtphys.assets.asset_model import AssetModel, Body, Part, contact, functional
from rtphys.assets.geometry import box, rounded_box
from rtphys.assets.lettering import write
from rtphys.assets.material import Colour, Picture, plastic, tint
from rtphys.assets.objects import Models
from rtphys.assets.pictures import plain, to_picture
from rtphys.assets.solid import Solid, hull
from rtphys.core.seeds import stream


@dataclass(frozen=True)
class Sign:
    """Sizes [m], lean and mass [kg]."""

    width: float
    length: float  # of the board, along its lean
    thick: float
    lean_deg: float
    front: float  # z of the board's lower front edge
    foot: tuple[float, float, float]  # width, height, and z of its rear edge
    mass: float


def sign(size: Sign, colour: Colour, word: str, words: tuple[str, ...]) -> AssetModel:
    """A board on a foot; `word` is printed above the code."""
    foot_w, foot_y, rear = size.foot
    board = _on_board(size, box(size.width, size.length, size.thick), 0.0)
    edge = _on_board(
        size, rounded_box(size.width, size.length, size.thick, 0.3 * size.thick, 1), 0.0
    )
    page = _on_board(
        size, box(0.92 * size.width, 0.94 * size.length, 0.001), size.thick / 2 + 0.0002
    )
    deep = size.front + 0.002 - rear
    foot = rounded_box(foot_w, foot_y, deep, 0.3 * foot_y, 1).at(
        0, foot_y / 2, size.front + 0.002 - deep / 2
    )
    brace = _brace(size)
    shell = plastic(colour, 0.5)
    ratio = size.width / size.length
    white = plastic((1, 1, 1), 0.5)
    side = min(0.86 * size.width, 0.70 * size.length)
    code = _on_board(size, box(side, side, 0.001), size.thick / 2 + 0.0005, -0.10 * size.length)
    looks = (
        Part(edge, shell, "plastic"),
        Part(foot + brace, plastic(tint(colour, 0.55), 0.5), "plastic"),
        Part(page, white.with_picture(_page(colour, word, ratio), "z"), "paper"),
        Part(code, white.with_picture(_code(word), "z"), "paper"),
    )
    up, _ = _axes(size)
    grip = _base(size) + (size.length - 0.010) * up
    return AssetModel(
        body=Body(looks, (board, foot, brace), size.mass),
        material="plastic",
        description=words,
        contact_points=tuple(contact(grip, up, (s, 0, 0)) for s in (1, -1)),
        functional_points=(functional((0, 0, 0), (0, -1, 0), (1, 0, 0)),),
        categories=("payment sign", "shop"),
    )


def _axes(size: Sign) -> tuple[np.ndarray, np.ndarray]:
    """Along the board upward, and out of its face."""
    a = np.radians(size.lean_deg)
    return np.array([0, np.cos(a), -np.sin(a)]), np.array([0, np.sin(a), np.cos(a)])


def _base(size: Sign) -> np.ndarray:
    """Middle of the board's lower edge; its front corner is on the ground."""
    out = _axes(size)[1]
    return np.array([0, out[1] * size.thick / 2, size.front]) - out * [0, 0, size.thick / 2]


def _on_board(size: Sign, solid: Solid, out: float, along: float = 0.0) -> Solid:
    """A part modelled upright about its middle, placed on the leaning board `along` its middle."""
    up, normal = _axes(size)
    middle = _base(size) + (size.length / 2 + along) * up + out * normal
    return solid.turned("x", -size.lean_deg).at(*middle)


def _brace(size: Sign) -> Solid:
    """A wedge behind the board that carries it. Convex."""
    up, out = _axes(size)
    foot_w, foot_y, rear = size.foot
    back = _base(size) - size.thick / 2 * out
    high, low = back + 0.55 * size.length * up, back + 0.05 * size.length * up
    ground = [np.array([0, 0.3 * foot_y, z]) for z in (low[2], rear + 0.004)]
    half = np.array([0.14 * foot_w, 0, 0])
    return hull([p + s * half for p in (high, low, *ground) for s in (-1, 1)])


def _page(colour: Colour, word: str, ratio: float) -> Picture:
    """A white page with a headline."""
    wide, high = (64, round(64 / ratio)) if ratio > 1 else (46, round(46 / ratio))
    if high > 64:
        wide, high = round(64 * ratio), 64
    canvas = plain((0.97, 0.97, 0.97), wide, high)
    canvas[:10] = colour
    return to_picture(write(canvas, word, 3, (1, 1, 1)))


def _code(name: str) -> Picture:
    """A code of 21 x 21 dots, with the corner marks of a pay code."""
    dots = stream(0, "assets", "pay code", name).random((21, 21)) < 0.48
    mark = np.ones((7, 7), bool)
    mark[1:6, 1:6] = False
    mark[2:5, 2:5] = True
    for r, c in ((0, 0), (0, 14), (14, 0)):
        dots[max(r - 1, 0) : r + 8, max(c - 1, 0) : c + 8] = False
        dots[r : r + 7, c : c + 7] = mark
    return to_picture(np.where(np.pad(dots, 1)[..., None], 0.03, 0.97) * np.ones(3))


BLUE, GREEN, RED, BLACK = (
    (0.10, 0.36, 0.80),
    (0.10, 0.58, 0.28),
    (0.80, 0.15, 0.12),
    (0.1, 0.1, 0.11),
)

MODELS: Models = {
    "070_paymentsign": {
        0: partial(
            sign,
            Sign(0.077, 0.0985, 0.0055, 15.6, 0.0150, (0.070, 0.006, -0.0165), 0.085),
            BLUE,
            "PAY",
            ("blue payment sign", "QR code sign", "small pay code board", "blue QR code stand"),
        ),
        1: partial(
            sign,
            Sign(0.175, 0.1230, 0.0085, 21.0, 0.0440, (0.150, 0.010, -0.0400), 0.24),
            GREEN,
            "SCAN TO PAY",
            ("green payment sign", "wide QR code sign", "large pay board", "green QR code stand"),
        ),
        2: partial(
            sign,
            Sign(0.118, 0.1600, 0.0080, 21.0, 0.0470, (0.100, 0.010, -0.0440), 0.22),
            RED,
            "PAY HERE",
            ("red payment sign", "QR code board", "tall red pay sign", "red QR code stand"),
        ),
        3: partial(
            sign,
            Sign(0.085, 0.1640, 0.0070, 25.5, 0.0390, (0.078, 0.010, -0.0380), 0.18),
            BLACK,
            "PAY",
            ("black payment sign", "narrow QR code sign", "tall pay board", "black QR code stand"),
        ),
    }
}
