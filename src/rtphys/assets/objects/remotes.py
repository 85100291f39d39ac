"""079_remotecontrol: remote controls; 0 and 1 lie along x, the others along z."""

from dataclasses import dataclass
from functools import partial

import numpy as np

from rtphys.assets.asset_model import AssetModel, Body, Part, contact, functional
from rtphys.assets.geometry import box
from rtphys.assets.material import Colour, Picture, plastic
from rtphys.assets.objects import Models
from rtphys.assets.pictures import plain, to_picture
from rtphys.assets.swept import dome, loft, slabs

LENGTH = 0.193  # [m]
# Along the remote, head last: place, width and height as shares.
ROWS = {
    "bar": ((-0.5, 0.92, 0.80), (-0.485, 1, 0.98), (0, 1, 1), (0.485, 1, 0.98), (0.5, 0.92, 0.8)),
    "waist": (
        (-0.5, 0.72, 0.62),
        (-0.45, 0.92, 0.86),
        (-0.25, 0.94, 1.0),
        (0.05, 0.84, 0.86),
        (0.32, 1.0, 0.74),
        (0.48, 0.94, 0.66),
        (0.5, 0.84, 0.55),
    ),
    "wedge": (
        (-0.5, 0.80, 0.80),
        (-0.46, 0.92, 1.0),
        (-0.20, 0.94, 0.96),
        (0.20, 0.97, 0.74),
        (0.48, 1.0, 0.60),
        (0.5, 0.94, 0.52),
    ),
}


@dataclass(frozen=True)
class Remote:
    """Sizes [m], outline, where the head points in the model frame, mass [kg]."""

    width: float
    height: float
    outline: str  # of ROWS
    head: str  # "+x", "+z" or "-z"
    mass: float


def remote(
    size: Remote, shell: Colour, accent: Colour, columns: int, words: tuple[str, ...]
) -> AssetModel:
    """A remote control with a printed keypad and a red power button."""
    w, h = size.width, size.height
    rows = ROWS[size.outline]
    rings = np.array([dome(b * w, c * h, a * LENGTH, 10, 5) for a, b, c in rows])
    # The keypad follows the upper side; it is the same sections, narrow and a hair higher.
    pad = np.array(
        [dome(0.80 * b * w, c * h / 0.968 + 0.0006, 0.94 * a * LENGTH, 4, 9) for a, b, c in rows]
    )
    keys_ = plastic((1, 1, 1), 0.4).with_picture(_keypad(shell, accent, columns, size.head), "y")
    eye = box(0.5 * rows[-1][1] * w, 0.35 * h, 0.003).at(0, 0.4 * rows[-1][2] * h, 0.4995 * LENGTH)
    angle = {"+z": 0, "+x": 90, "-z": 180}[size.head]
    looks = (
        Part(loft(rings).turned("y", angle), plastic(shell, 0.4), "plastic", 40),
        Part(loft(pad).turned("y", angle), keys_, "rubber"),
        Part(eye.turned("y", angle), plastic((0.25, 0.03, 0.06), 0.9), "plastic"),
    )
    count = len(rows) - 1
    parts = slabs(rings, (0, count) if size.outline == "bar" else (0, 2, count - 2, count))
    ahead = {"+z": (0, 0, 1.0), "+x": (1.0, 0, 0), "-z": (0, 0, -1.0)}[size.head]
    along = np.array([1.0, 0, 0]) if size.head == "+x" else np.array([0, 0, 1.0])
    grip = (0, 0.45 * h, 0)
    tip = np.array(ahead) * LENGTH / 2 + [0, 0.4 * h, 0]
    return AssetModel(
        body=Body(looks, tuple(p.turned("y", angle) for p in parts), size.mass),
        material="plastic",
        description=words,
        contact_points=tuple(contact(grip, (0, 1, 0), s * along) for s in (1, -1)),
        functional_points=(functional(tip, ahead, np.cross((0, 1, 0), ahead)),),
        categories=("remote control", "electronics"),
    )


def _keypad(shell: Colour, accent: Colour, columns: int, head: str) -> Picture:
    """Rows of keys, a ring of arrows, a red key at the head, which is the picture's foot (+z)."""
    dark = sum(shell) < 1.5
    key = (0.85, 0.85, 0.86) if dark else (0.22, 0.22, 0.25)
    canvas = plain(shell, 24, 64)
    step = 24 // columns
    for r in range(6, 34, 6):
        for c in range(columns):
            x = c * step + 2
            canvas[r : r + 4, x : x + step - 3] = key if (r // 6) % 4 else accent
    y, x = np.mgrid[0:64, 0:24]
    ring = np.hypot(x - 11.5, y - 44)
    canvas[ring < 8.5] = key
    canvas[ring < 4] = accent
    canvas[57:61, 16:21] = (0.90, 0.08, 0.08)
    canvas[57:61, 3:8] = key
    turns = {"+z": 0, "+x": 1, "-z": 2}[head]
    return np.rot90(to_picture(canvas), turns).copy()


BLACK, WHITE, GREY = (0.09, 0.09, 0.10), (0.92, 0.92, 0.92), (0.42, 0.44, 0.47)
BLUE, ORANGE, TEAL = (0.20, 0.40, 0.85), (0.95, 0.55, 0.15), (0.15, 0.65, 0.60)
SILVER, NAVY = (0.74, 0.75, 0.78), (0.12, 0.16, 0.34)

MODELS: Models = {
    "079_remotecontrol": {
        0: partial(
            remote,
            Remote(0.0478, 0.0205, "bar", "+x", 0.115),
            BLACK,
            BLUE,
            3,
            ("black remote control", "TV remote", "slim black remote", "black remote"),
        ),
        1: partial(
            remote,
            Remote(0.0570, 0.0218, "bar", "+x", 0.130),
            WHITE,
            ORANGE,
            4,
            ("white remote control", "white TV remote", "flat white remote", "white remote"),
        ),
        2: partial(
            remote,
            Remote(0.0645, 0.0390, "waist", "-z", 0.175),
            GREY,
            TEAL,
            3,
            ("grey remote control", "curved grey remote", "thick remote", "grey TV remote"),
        ),
        3: partial(
            remote,
            Remote(0.0690, 0.0232, "wedge", "+z", 0.140),
            NAVY,
            ORANGE,
            4,
            ("dark blue remote control", "blue remote", "wide remote", "blue TV remote"),
        ),
        4: partial(
            remote,
            Remote(0.0680, 0.0258, "bar", "-z", 0.155),
            SILVER,
            BLUE,
            4,
            ("silver remote control", "silver remote", "wide silver remote", "silver TV remote"),
        ),
        5: partial(
            remote,
            Remote(0.0615, 0.0308, "waist", "-z", 0.150),
            BLACK,
            ORANGE,
            3,
            ("curved black remote", "black waisted remote", "remote control", "ergonomic remote"),
        ),
        6: partial(
            remote,
            Remote(0.0632, 0.0386, "wedge", "+z", 0.170),
            TEAL,
            WHITE,
            3,
            ("teal remote control", "green remote", "wedge shaped remote", "thick teal remote"),
        ),
    }
}
