"""154_tape: hollow rolls that lie flat. 153_steel-tape: measuring tapes on their long side."""

from functools import partial

import numpy as np

from rtphys.assets.asset_model import AssetModel, Body, Part
from rtphys.assets.geometry import box, circle, extrude
from rtphys.assets.lettering import write
from rtphys.assets.material import Colour, matt, metal, plastic
from rtphys.assets.objects import Models
from rtphys.assets.parts import shell_parts
from rtphys.assets.pictures import plain, to_picture
from rtphys.assets.solid import Solid
from rtphys.assets.swept import bevelled

SIDES = 20


def roll(
    size: tuple[float, float, float], tape: Colour, core: Colour, words: tuple[str, ...]
) -> AssetModel:
    """A roll of sticky tape; outer and inner radius and height [m]."""
    outer, inner, high = size
    liner = inner + 0.003
    wound = extrude(circle(outer, SIDES), high) - extrude(circle(liner, SIDES), 3 * high).at(
        y=-high
    )
    spool = extrude(circle(liner, SIDES), high) - extrude(circle(inner, SIDES), 3 * high).at(
        y=-high
    )
    flag = box(0.012, high, 0.0012).at(outer + 0.003, high / 2, -0.002)
    looks = (
        Part(wound, plastic(tape, 0.7), "plastic"),
        Part(spool, matt(core), "cardboard"),
        Part(flag, plastic(tape, 0.4), "plastic"),
    )
    ring = shell_parts([(outer, 0), (outer, high)], [(inner, 0), (inner, high)], 10)
    return _thing(looks, (*ring, flag), 0.06 + 25 * outer * high, words, "tape")


def _hoop(outer: float, inner: float, high: float) -> Solid:
    hole = extrude(circle(inner, SIDES), 3 * high).at(y=-high)
    return extrude(circle(outer, SIDES), high) - hole


def steel_tape(
    size: tuple[float, float, float], case: Colour, words: tuple[str, ...]
) -> AssetModel:
    """A measuring tape with its end out at +z; x, y, z of the case [m]."""
    x, y, z = size
    r = 0.5 * y
    turns = np.radians(np.arange(0, 181, 22.5))
    back = [(-z / 2 + r - r * np.sin(t), r + r * np.cos(t)) for t in turns]
    outline = [(z / 2, 0), (z / 2, 0.45 * y), (z / 2 - 0.30 * z, y), *back]
    shell = bevelled(np.array(outline), x, 0.004)
    disc = extrude(circle(0.32 * y, 20), 1.01 * x).at(y=-0.505 * x).turned("z", 90)
    disc = disc.at(0, 0.52 * y, -0.06 * z)
    blade = box(0.62 * x, 0.0012, 0.024).at(0, 0.004, z / 2 + 0.011)
    hook = box(0.62 * x, 0.010, 0.0016).at(0, 0.005, z / 2 + 0.0235)
    face = write(plain((0.95, 0.95, 0.93), 24, 24), "5M", 7, (0.1, 0.1, 0.1), 2)
    looks = (
        Part(shell, plastic(case, 0.5), "plastic"),
        Part(disc, plastic((1, 1, 1), 0.4).with_picture(to_picture(face), "x"), "plastic"),
        Part(blade, plastic((0.96, 0.86, 0.20), 0.5), "steel"),
        Part(hook, metal(), "steel"),
    )
    tongue = box(0.62 * x, 0.010, 0.024).at(0, 0.005, z / 2 + 0.0125)
    return _thing(looks, (shell, tongue), 0.22, words, "steel tape")


def _thing(
    looks: tuple[Part, ...],
    parts: tuple[Solid, ...],
    mass: float,
    words: tuple[str, ...],
    kind: str,
) -> AssetModel:
    return AssetModel(
        body=Body(looks, parts, mass),
        material="plastic",
        description=words,
        categories=(kind, "tool"),
    )


KRAFT, GREY = (0.68, 0.50, 0.32), (0.62, 0.64, 0.66)

MODELS: Models = {
    "153_steel-tape": {
        0: partial(
            steel_tape,
            (0.034, 0.062, 0.070),
            (0.96, 0.72, 0.10),
            ("yellow tape measure", "measuring tape", "steel tape", "tape measure"),
        ),
        1: partial(
            steel_tape,
            (0.030, 0.052, 0.058),
            (0.80, 0.14, 0.12),
            ("red tape measure", "small tape measure", "red measuring tape", "red steel tape"),
        ),
        2: partial(
            steel_tape,
            (0.040, 0.074, 0.082),
            (0.13, 0.14, 0.16),
            ("black tape measure", "big tape measure", "black steel tape", "black measuring tape"),
        ),
    },
    "154_tape": {
        0: partial(
            roll,
            (0.048, 0.038, 0.046),
            (0.75, 0.58, 0.36),
            KRAFT,
            ("roll of brown tape", "packing tape", "brown tape", "roll of tape"),
        ),
        1: partial(
            roll,
            (0.044, 0.026, 0.020),
            (0.12, 0.30, 0.68),
            (0.90, 0.90, 0.88),
            ("roll of blue tape", "blue tape", "narrow tape roll", "blue sticky tape"),
        ),
        2: partial(
            roll,
            (0.056, 0.037, 0.048),
            GREY,
            KRAFT,
            ("roll of grey tape", "duct tape", "thick tape roll", "silver tape"),
        ),
        3: partial(
            roll,
            (0.038, 0.020, 0.026),
            (0.85, 0.16, 0.16),
            (0.92, 0.88, 0.80),
            ("roll of red tape", "red tape", "small tape roll", "red sticky tape"),
        ),
    },
}
