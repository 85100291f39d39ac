"""076_breadbasket and 110_basket: wicker baskets; the second kind is carried by an arch.

The arch stands over the middle, along z, and is a flat strip: the fingers close on its broad sides
along x. Functional points are the official ones (of the bread basket: a little above its floor).
"""

from dataclasses import dataclass
from functools import partial
from itertools import pairwise

import numpy as np

from rtphys.assets.asset_model import AssetModel, Body, Part, contact, functional
from rtphys.assets.material import Colour, Finish, matt, tint
from rtphys.assets.objects import Models
from rtphys.assets.pictures import speckle
from rtphys.assets.rounded_tray import RoundedTray
from rtphys.assets.solid import Solid, hull, together
from rtphys.assets.weaves import wicker
from rtphys.assets.words import Words, phrases

STRIP = (0.024, 0.010)  # [m] the arch's width and thickness: fingers need room against tipping
LEGS = 7  # straight pieces of an arch


@dataclass(frozen=True)
class Arch:
    """Sizes [m] of a carried basket."""

    top: float  # y of the arch's upper side
    grip: float  # y of the contact points
    drops: tuple[tuple[float, float], tuple[float, float]]  # x, y of functional points 0 and 1


def bread_basket(
    size: RoundedTray, mass: float, drop: float, colours: tuple[Colour, Colour], words: Words
) -> AssetModel:
    """A shallow basket with a cloth in it."""
    weave, cloth = colours
    return AssetModel(
        body=Body(_woven(size, weave, cloth), (*size.parts(), *size.rim_parts()), mass),
        material="wicker",
        description=phrases(*words, "basket"),
        functional_points=(functional((0, drop, 0), (0, 1, 0), (1, 0, 0)),),
        categories=("bread basket", "kitchen"),
    )


def carried_basket(
    size: RoundedTray, mass: float, arch: Arch, colours: tuple[Colour, Colour], words: Words
) -> AssetModel:
    """A basket with an arch over its middle."""
    weave, dark = colours
    strip = _arch(size, arch.top)
    looks = (
        *_woven(size, weave, tint(weave, 0.8)),
        Part(together(*strip), matt(dark), "wicker"),
    )
    return AssetModel(
        body=Body(looks, (*size.parts(), *size.rim_parts(), *strip), mass),
        material="wicker",
        description=phrases(*words, "carrying basket"),
        contact_points=tuple(contact((0, arch.grip, 0), (0, 1, 0), (0, 0, s)) for s in (-1, 1)),
        functional_points=tuple(functional((x, y, 0), (0, 0, 1), (1, 0, 0)) for x, y in arch.drops),
        categories=("basket", "kitchen"),
    )


def _woven(size: RoundedTray, weave: Colour, cloth: Colour) -> tuple[Part, ...]:
    walls: Finish = matt((1, 1, 1)).with_picture(wicker(weave), "cylinder")
    inside = matt((1, 1, 1)).with_picture(speckle(cloth, "cloth", 0.12), "y")
    edge = matt(tint(weave, 0.6))
    return (
        Part(size.shell(), walls, "wicker"),
        Part(size.rim(), edge, "wicker"),
        Part(size.liner(), inside, "fabric"),
    )


def _arch(size: RoundedTray, top: float) -> tuple[Solid, ...]:
    """Half an ellipse in the plane x = 0, from wall to wall, as straight strips."""
    wide, thick = STRIP
    foot = 0.5 * size.y
    half = size.outline(foot)[:, 2].max() + 0.5 * thick
    # The middle piece lies flat at the top, under the fingers.
    rise = (top - foot) / np.cos(0.5 * np.pi / LEGS)
    angles = np.linspace(0, np.pi, LEGS + 1)
    middle, inner = (
        np.stack([(half - t) * np.cos(angles), foot + (rise - t) * np.sin(angles)], axis=1)
        for t in (0.0, thick)
    )
    strips = []
    for (a, b), (c, d) in zip(pairwise(middle), pairwise(inner), strict=True):
        corners = [(x, p[1], p[0]) for x in (-wide / 2, wide / 2) for p in (a, b, c, d)]
        strips.append(hull(corners))
    return tuple(strips)


STRAW, HONEY, BROWN = (0.82, 0.66, 0.40), (0.72, 0.50, 0.24), (0.45, 0.28, 0.15)
PALE, GREY, RED = (0.90, 0.80, 0.60), (0.62, 0.58, 0.52), (0.78, 0.22, 0.20)
WHITE, BLUE, GREEN = (0.93, 0.92, 0.88), (0.32, 0.45, 0.65), (0.45, 0.58, 0.38)

MODELS: Models = {
    "076_breadbasket": {
        0: partial(
            bread_basket, RoundedTray(0.190, 0.062, 0.134, 0.84, 0.005, 0.006, 0.03, 2), 0.16,
            0.0084, (STRAW, RED), ("bread basket", "straw-coloured", "a red cloth"),
        ),
        1: partial(
            bread_basket, RoundedTray(0.188, 0.051, 0.137, 0.90, 0.005, 0.006, 0.012), 0.15, 0.0157,
            (HONEY, WHITE), ("bread basket", "brown", "a white cloth"),
        ),
        2: partial(
            bread_basket, RoundedTray(0.208, 0.085, 0.170, 0.78, 0.005, 0.006, 0.05, 2), 0.22,
            0.0111, (BROWN, BLUE), ("deep bread basket", "dark brown", "a blue cloth"),
        ),
        3: partial(
            bread_basket, RoundedTray(0.190, 0.046, 0.137, 0.86, 0.005, 0.006, 0.04, 2), 0.14,
            0.0135, (PALE, GREEN), ("bread basket", "pale", "a green cloth"),
        ),
        4: partial(
            bread_basket, RoundedTray(0.188, 0.075, 0.188, 0.72, 0.005, 0.006, 0.094, 3), 0.21,
            0.0341, (GREY, WHITE), ("round bread basket", "grey", "a white cloth"),
        ),
    },
    "110_basket": {
        0: partial(
            carried_basket, RoundedTray(0.228, 0.085, 0.142, 0.88, 0.005, 0.006, 0.02), 0.12,
            Arch(0.1745, 0.1704, ((0.0552, 0.1093), (-0.0548, 0.1095))),
            (HONEY, BROWN), ("basket", "brown", "an arched handle"),
        ),
        1: partial(
            carried_basket, RoundedTray(0.231, 0.080, 0.149, 0.80, 0.005, 0.006, 0.05, 2), 0.12,
            Arch(0.1760, 0.1621, ((0.0672, 0.1017), (-0.0699, 0.0999))),
            (PALE, HONEY), ("oval basket", "straw-coloured", "a golden handle"),
        ),
        2: partial(
            carried_basket, RoundedTray(0.230, 0.090, 0.158, 0.92, 0.005, 0.006, 0.012), 0.13,
            Arch(0.1760, 0.1708, ((0.0719, 0.0963), (-0.0686, 0.0958))),
            (GREY, BROWN), ("square basket", "grey", "a dark handle"),
        ),
    },
}  # fmt: skip
