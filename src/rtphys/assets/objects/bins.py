"""011_dustbin and 063_tabletrashbin: the big floor bin and small desk bins.

The floor of the big bin is raised by 21.5 cm: objects in it are then between the heights
that the throwing tasks ask for (balls 13 to 25 cm, bottles 20 to 70 cm).
"""

from functools import partial

from rtphys.assets.asset_model import Array, AssetModel, Body, Part, contact
from rtphys.assets.geometry import cylinder
from rtphys.assets.material import Colour, metal, plastic
from rtphys.assets.objects import Models
from rtphys.assets.rounded_tray import RoundedTray
from rtphys.assets.solid import together
from rtphys.assets.vessel import Vessel, band
from rtphys.assets.weaves import slats
from rtphys.assets.words import Words, phrases

# [m] by which a desk bin's rim stands out. It is paint: fingers close on the wall itself.
BEAD = 0.0005


def dustbin(size: RoundedTray, mass: float) -> AssetModel:
    """A big bin with a rim and two wheels."""
    grey, dark = plastic((0.30, 0.45, 0.36), 0.3), plastic((0.10, 0.11, 0.12), 0.2)
    wheels = [cylinder(0.045, 0.04, 16).turned("z", 90).at(s * 0.19, 0.045, -0.17) for s in (-1, 1)]
    looks = (
        Part(size.shell(), grey),
        Part(together(size.rim(0.0035, 0.03), *wheels), dark),
    )
    return AssetModel(
        body=Body(looks, (*size.parts(), *size.rim_parts(0.0035, 0.03), *wheels), mass),
        material="plastic",
        description=phrases("dustbin", "green", "a black rim", "waste bin"),
        categories=("dustbin", "household"),
    )


def round_bin(
    size: Vessel, mass: float, grip: float, colours: tuple[Colour, Colour], words: Words
) -> AssetModel:
    """A desk bin turned about y."""
    shell, stripe = colours
    finish = metal(shell) if words[1] == "steel" else plastic(shell, 0.4)
    top = size.outer[-1][1]
    looks = (
        Part(size.shell(), finish, crease_deg=50),
        Part(band(size.outer, 0.72 * top, 0.90 * top, size.sides), plastic(stripe, 0.4)),
    )
    r = size.radius(grip) - 0.5 * size.wall
    return _bin(Body(looks, size.parts(), mass), (r, r), grip, words)


def square_bin(
    size: RoundedTray, mass: float, grip: float, colours: tuple[Colour, Colour], words: Words
) -> AssetModel:
    """A desk bin with four walls."""
    shell, rim = colours
    picture = slats(shell, (0.12, 0.12, 0.13)) if words[2] == "slits" else None
    finish = plastic(shell, 0.4)
    if picture is not None:
        finish = plastic((1, 1, 1), 0.4).with_picture(picture, "cylinder")
    looks = (Part(size.shell(), finish), Part(size.rim(BEAD), plastic(rim, 0.4)))
    x, z = size.outline(grip, 0.5 * size.wall).max(0)[[0, 2]]
    return _bin(Body(looks, size.parts(), mass), (float(x), float(z)), grip, words)


def _bin(body: Body, reach: tuple[float, float], grip: float, words: Words) -> AssetModel:
    x, z = reach
    return AssetModel(
        body=body,
        material="plastic",
        description=phrases(*words, "waste basket"),
        contact_points=(*_across("x", x, grip), *_across("z", z, grip)),
        categories=("bin", "office"),
    )


def _across(axis: str, reach: float, y: float) -> list[Array]:
    """Grasps from above across the walls, both yaws each; official order -x, +x, +z, -z."""
    if axis == "x":
        return [contact((s * reach, y, 0), (0, 1, 0), (0, 0, t)) for s in (-1, 1) for t in (1, -1)]
    return [contact((0, y, s * reach), (0, 1, 0), (t, 0, 0)) for s in (1, -1) for t in (-1, 1)]


GREY, BLACK, WHITE = (0.55, 0.57, 0.60), (0.12, 0.12, 0.13), (0.92, 0.92, 0.90)
BLUE, GREEN, PINK = (0.16, 0.38, 0.70), (0.36, 0.62, 0.40), (0.92, 0.64, 0.70)
STEEL, TEAL, YELLOW = (0.72, 0.74, 0.77), (0.18, 0.55, 0.56), (0.95, 0.78, 0.22)

MODELS: Models = {
    "011_dustbin": {
        0: partial(dustbin, RoundedTray(0.640, 0.735, 0.430, 0.80, 0.012, 0.215, 0.05), 4.5),
    },
    "063_tabletrashbin": {
        0: partial(
            square_bin, RoundedTray(0.149, 0.131, 0.149, 0.84, 0.0035, 0.004, 0.020, 2), 0.09,
            0.1296, (GREY, BLACK), ("desk bin", "grey", "slits"),
        ),
        3: partial(
            round_bin,
            Vessel(((0.055, 0), (0.064, 0.05), (0.0755, 0.1435)), 0.0035, 0.004),
            0.085, 0.1390, (WHITE, TEAL), ("desk bin", "white", "a teal stripe"),
        ),
        6: partial(
            square_bin, RoundedTray(0.185, 0.096, 0.126, 0.86, 0.0035, 0.004, 0.015), 0.08, 0.0895,
            (PINK, WHITE), ("desk bin", "pink", "a white rim"),
        ),
        7: partial(
            round_bin,
            Vessel(((0.0365, 0), (0.0425, 0.1160)), 0.0035, 0.004),
            0.045, 0.1125, (BLUE, YELLOW), ("small desk bin", "blue", "a yellow stripe"),
        ),
        8: partial(
            square_bin, RoundedTray(0.0815, 0.116, 0.0815, 0.92, 0.0035, 0.004, 0.008), 0.05,
            0.1145, (BLACK, GREY), ("small desk bin", "black", "a grey rim"),
        ),
        9: partial(
            round_bin,
            Vessel(((0.0400, 0), (0.0405, 0.03), (0.0490, 0.1165)), 0.0035, 0.004),
            0.05, 0.1135, (STEEL, BLACK), ("small desk bin", "steel", "a black stripe"),
        ),
        10: partial(
            square_bin, RoundedTray(0.0840, 0.135, 0.0840, 0.90, 0.0035, 0.004, 0.025, 2), 0.055,
            0.1320, (GREEN, WHITE), ("small desk bin", "green", "slits"),
        ),
    },
}  # fmt: skip
