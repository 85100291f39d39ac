"""151_calculator and 116_keyboard: flat devices with keys; official calculators are metres wide."""

from dataclasses import dataclass
from functools import partial

import numpy as np

from rtphys.assets.asset_model import AssetModel, Body, Part
from rtphys.assets.geometry import box
from rtphys.assets.lettering import write
from rtphys.assets.material import Colour, Picture, plastic, tint
from rtphys.assets.objects import Models
from rtphys.assets.pictures import keys, plain, to_picture
from rtphys.assets.solid import Solid
from rtphys.assets.swept import bevelled


@dataclass(frozen=True)
class Wedge:
    """Sizes [m]; `rear` is the height at -z, `front` at +z."""

    x: float
    z: float
    rear: float
    front: float
    mass: float


def calculator(size: Wedge, body: Colour, keycap: Colour, words: tuple[str, ...]) -> AssetModel:
    """A pocket calculator with a grey display."""
    shell = _wedge(size)
    pad = _on_top(size, 0.86, 0.60, 0.17)
    window = _on_top(size, 0.80, 0.18, -0.32)
    solar = _on_top(size, 0.36, 0.07, -0.455)
    looks = (
        Part(shell, plastic(body, 0.4), "plastic"),
        Part(pad, plastic((1, 1, 1), 0.4).with_picture(_buttons(body, keycap), "y"), "rubber"),
        Part(window, plastic((1, 1, 1), 0.6).with_picture(_number(), "y"), "glass"),
        Part(solar, plastic((0.22, 0.14, 0.16), 0.8), "glass"),
    )
    return _thing(looks, shell, size, words, "calculator")


def keyboard(size: Wedge, body: Colour, keycap: Colour, words: tuple[str, ...]) -> AssetModel:
    """A small keyboard, its keys raised."""
    shell = _wedge(size)
    pad = _on_top(size, 0.96, 0.90, 0.0, 0.0035)
    caps = plastic((1, 1, 1), 0.4).with_picture(keys(tint(body, 0.6), keycap, 14, 5), "y")
    looks = (Part(shell, plastic(body, 0.4), "plastic"), Part(pad, caps, "plastic"))
    whole = bevelled(
        [(-size.z / 2, 0), (size.z / 2, 0), (size.z / 2, size.front + 0.0017),
         (-size.z / 2, size.rear + 0.0017)], size.x, 0.001)  # fmt: skip
    return _thing(looks, whole, size, words, "keyboard")


def _wedge(size: Wedge) -> Solid:
    h = size.z / 2
    return bevelled([(-h, 0), (h, 0), (h, size.front), (-h, size.rear)], size.x, 0.002)


def _on_top(size: Wedge, wide: float, deep: float, middle: float, thick: float = 0.0016) -> Solid:
    """A slab on the slanted top; `wide`, `deep` and `middle` are shares of its width and depth."""
    slope = (size.front - size.rear) / size.z
    slab = box(wide * size.x, thick, deep * size.z).turned("x", -np.degrees(np.arctan(slope)))
    y = (size.front + size.rear) / 2 + slope * middle * size.z
    return slab.at(0, y, middle * size.z)


def _thing(
    looks: tuple[Part, ...], part: Solid, size: Wedge, words: tuple[str, ...], kind: str
) -> AssetModel:
    return AssetModel(
        body=Body(looks, (part,), size.mass),
        material="plastic",
        description=words,
        categories=(kind, "electronics"),
    )


def _buttons(body: Colour, keycap: Colour) -> Picture:
    canvas = plain(body, 33, 41)
    for r in range(5):
        for c in range(4):
            ink = keycap
            if c == 3:
                ink = (0.92, 0.52, 0.14)
            if r == 0:
                ink = (0.80, 0.18, 0.16) if c == 0 else (0.45, 0.47, 0.50)
            canvas[1 + 8 * r : 7 + 8 * r, 1 + 8 * c : 8 + 8 * c] = ink
    return to_picture(canvas)


def _number() -> Picture:
    canvas = plain((0.66, 0.74, 0.64), 40, 13)
    return to_picture(write(canvas, "123456.7", 4, (0.08, 0.10, 0.08)))


BLACK, WHITE, GREY = (0.13, 0.13, 0.14), (0.92, 0.92, 0.90), (0.55, 0.57, 0.60)
PINK, NAVY, CREAM = (0.92, 0.62, 0.68), (0.14, 0.20, 0.38), (0.90, 0.86, 0.76)

MODELS: Models = {
    "116_keyboard": {
        0: partial(
            keyboard,
            Wedge(0.154, 0.054, 0.018, 0.010, 0.16),
            WHITE,
            (0.97, 0.97, 0.97),
            ("white keyboard", "small keyboard", "mini keyboard", "white computer keyboard"),
        ),
        1: partial(
            keyboard,
            Wedge(0.154, 0.054, 0.017, 0.010, 0.16),
            BLACK,
            (0.32, 0.33, 0.36),
            ("black keyboard", "small black keyboard", "keyboard", "black computer keyboard"),
        ),
        2: partial(
            keyboard,
            Wedge(0.152, 0.052, 0.019, 0.011, 0.17),
            NAVY,
            CREAM,
            ("blue keyboard", "retro keyboard", "keyboard with cream keys", "dark blue keyboard"),
        ),
    },
    "151_calculator": {
        0: partial(
            calculator,
            Wedge(0.082, 0.140, 0.022, 0.012, 0.11),
            BLACK,
            (0.85, 0.85, 0.86),
            ("black calculator", "pocket calculator", "calculator", "calculator with white keys"),
        ),
        1: partial(
            calculator,
            Wedge(0.105, 0.135, 0.030, 0.013, 0.15),
            WHITE,
            (0.30, 0.32, 0.36),
            ("white calculator", "desk calculator", "wide calculator", "white desk calculator"),
        ),
        2: partial(
            calculator,
            Wedge(0.075, 0.120, 0.014, 0.010, 0.08),
            PINK,
            (0.97, 0.95, 0.95),
            ("pink calculator", "small calculator", "small pink calculator", "pink adding machine"),
        ),
    },
}
