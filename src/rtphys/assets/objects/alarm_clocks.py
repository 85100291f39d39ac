"""046_alarm-clock: box clocks with a snooze bar, and round ones with two bells and a button.

The button to press stands 0.9 to 1.2 cm above the contact point: fingertips, which end at the
point's height, must touch it within 3 cm. Official model 3 does not keep to this.
"""

from dataclasses import dataclass
from functools import partial

import numpy as np

from rtphys.assets.asset_model import AssetModel, Body, Part, contact
from rtphys.assets.geometry import box, cylinder, lathe, rounded_box
from rtphys.assets.lettering import dots
from rtphys.assets.material import Colour, Finish, Picture, metal, plastic, tint
from rtphys.assets.objects import Models
from rtphys.assets.pictures import plain, to_picture
from rtphys.assets.solid import Solid, hull, together
from rtphys.assets.swept import bevelled

FOOT = 0.004  # [m]


@dataclass(frozen=True)
class Clock:
    """Sizes [m] (box around it), point to press (y, z) and mass [kg]."""

    width: float
    height: float  # of the button's top
    depth: float
    press: tuple[float, float]
    mass: float


def digital(
    size: Clock, shell: Colour, glow: Colour, button: Colour, words: tuple[str, ...]
) -> AssetModel:
    """A box with a lit display to +z and a wide button on top."""
    w, d, top = size.width, size.depth, size.height - 0.010
    half = d / 2
    side = np.array([(-half, FOOT), (half, FOOT), (0.72 * half, top), (-0.85 * half, top)])
    case = bevelled(side, w, 0.006)
    lean = np.degrees(np.arctan2(0.28 * half, top - FOOT))
    window = box(0.86 * w, 0.62 * (top - FOOT), 0.002).turned("x", -lean)
    window = window.at(0, (top + FOOT) / 2, 0.86 * half + 0.0002)
    bar = rounded_box(0.45 * w, 0.014, 0.5 * d, 0.004, 2).at(0, top + 0.003, size.press[1])
    feet = [box(0.02, 0.01, 0.8 * d).at(s * 0.36 * w, 0.005, 0) for s in (-1, 1)]
    digits = plastic((1, 1, 1), 0.6).with_picture(_digits(glow), "z")
    looks = (
        Part(case, plastic(shell, 0.5), "plastic"),
        Part(window, digits, "plastic"),
        Part(bar, plastic(button, 0.6), "plastic"),
        Part(together(*feet), plastic(tint(shell, 0.6), 0.1), "rubber"),
    )
    return _thing(size, looks, (case, bar, *feet), words)


def twin_bells(
    size: Clock, paint: Finish, bells: Finish, dial: Colour, words: tuple[str, ...]
) -> AssetModel:
    """A round clock on two feet, two bells on top and a button between them."""
    r = size.width / 2 - 0.012
    y = r + 0.012
    drum = cylinder(r, 0.72 * size.depth, 24).turned("x", 90).at(0, y, 0)
    face = cylinder(0.86 * r, 0.002, 24).turned("x", 90).at(0, y, 0.36 * size.depth)
    white = plastic((1, 1, 1), 0.4).with_picture(_dial(dial), "z")
    cap = lathe([(0, 0), (0.036, 0), (0.033, 0.014), (0.020, 0.026), (0, 0.031)], 16)
    cap = cap.scaled(0.49 * size.depth / 0.036)
    domes = [cap.turned("z", -38 * s).at(s * 0.60 * r, y + 0.83 * r, 0) for s in (-1, 1)]
    stem_foot = y + 0.9 * r
    stem = cylinder(0.006, size.height - stem_foot, 10).at(y=(size.height + stem_foot) / 2)
    knob = rounded_box(0.030, 0.014, 0.026, 0.004, 2).at(0, size.height - 0.007, size.press[1])
    legs = [_leg(s, r, y, size.depth) for s in (-1, 1)]
    looks = (
        Part(drum, paint, "steel", 40),
        Part(face, white, "plastic"),
        Part(together(*domes), bells, "steel", 50),
        Part(together(stem, knob, *legs), metal((0.35, 0.36, 0.38)), "steel"),
    )
    return _thing(size, looks, (drum, *domes, stem, knob, *legs), words)


def _leg(side: int, r: float, y: float, depth: float) -> Solid:
    """A thick leg, from inside the drum to the ground, with a flat sole."""
    sole = box(0.020, 0.004, depth).at(side * 0.62 * r, 0.002, 0)
    root = box(0.020, 0.010, 0.5 * depth).at(side * 0.5 * r, y - 0.75 * r, 0)
    return hull([*sole.vertices, *root.vertices])


def _thing(
    size: Clock, looks: tuple[Part, ...], parts: tuple[Solid, ...], words: tuple[str, ...]
) -> AssetModel:
    y, z = size.press
    return AssetModel(
        body=Body(looks, parts, size.mass),
        material="plastic",
        description=words,
        contact_points=tuple(contact((0, y, z), (0, 1, 0), (s, 0, 0)) for s in (1, -1)),
        categories=("alarm clock", "electronics"),
    )


def _digits(glow: Colour) -> Picture:
    canvas = plain((0.03, 0.03, 0.04), 60, 32)
    pattern = np.kron(dots("7:30"), np.ones((3, 3), bool))
    h, w = pattern.shape
    canvas[8 : 8 + h, (60 - w) // 2 : (60 - w) // 2 + w][pattern] = glow
    return to_picture(canvas)


def _dial(ink: Colour) -> Picture:
    """A dial with twelve marks and two hands."""
    y, x = np.mgrid[0:64, 0:64] - 31.5
    radius, angle = np.hypot(x, y), np.degrees(np.arctan2(x, -y)) % 360
    canvas = plain((0.97, 0.96, 0.92), 64, 64)
    near = np.abs((angle + 15) % 30 - 15)
    canvas[(radius > 22) & (radius < 28) & (near * radius < 90)] = ink
    canvas[radius > 29.5] = ink
    for direction_deg, length, width in ((305, 15, 2.0), (60, 22, 1.4)):
        a = np.radians(direction_deg)
        along, across = x * np.sin(a) - y * np.cos(a), x * np.cos(a) + y * np.sin(a)
        canvas[(along > -3) & (along < length) & (abs(across) < width)] = (0.08, 0.08, 0.10)
    canvas[radius < 2.5] = (0.8, 0.1, 0.1)
    return to_picture(canvas)


BLACK, WHITE = (0.09, 0.09, 0.10), (0.92, 0.92, 0.90)
CHROME, BRASS = metal((0.80, 0.81, 0.84), 0.25), metal((0.86, 0.68, 0.28), 0.3)
RED, GREEN, CYAN = (1.0, 0.18, 0.12), (0.25, 1.0, 0.35), (0.35, 0.80, 1.0)

MODELS: Models = {
    "046_alarm-clock": {
        1: partial(
            digital,
            Clock(0.190, 0.1215, 0.082, (0.1112, 0.0), 0.42),
            BLACK,
            RED,
            (0.75, 0.76, 0.78),
            ("digital alarm clock", "black alarm clock", "clock with red digits", "radio clock"),
        ),
        2: partial(
            digital,
            Clock(0.188, 0.1400, 0.070, (0.1294, -0.0036), 0.38),
            WHITE,
            GREEN,
            (0.90, 0.45, 0.15),
            (
                "white alarm clock",
                "clock with green digits",
                "digital clock",
                "white digital clock",
            ),
        ),
        3: partial(
            twin_bells,
            Clock(0.150, 0.1770, 0.070, (0.1650, 0.0), 0.46),
            plastic((0.78, 0.12, 0.12), 0.7),
            CHROME,
            (0.10, 0.10, 0.12),
            ("red alarm clock", "alarm clock with two bells", "round clock", "twin bell clock"),
        ),
        4: partial(
            twin_bells,
            Clock(0.140, 0.1510, 0.060, (0.1395, 0.0), 0.40),
            plastic((0.20, 0.55, 0.62), 0.7),
            BRASS,
            (0.10, 0.20, 0.40),
            ("blue alarm clock", "clock with brass bells", "round blue clock", "bedside clock"),
        ),
    }
}
