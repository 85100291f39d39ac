"""075_bread: loaves, rolls, slices and a croissant, all flat below so that they lie still."""

from functools import partial
from itertools import pairwise

import numpy as np

from rtphys.assets.asset_model import Array, AssetModel, Body, Part, contact, from_above
from rtphys.assets.bread import bread, crust, scored
from rtphys.assets.geometry import box, extrude, lathe, rounded
from rtphys.assets.material import Colour, Finish, matt
from rtphys.assets.objects import Models
from rtphys.assets.pictures import speckle
from rtphys.assets.solid import Solid, hull, together
from rtphys.assets.words import Words, phrases

GOLD, BROWN, CRUMB = (0.80, 0.52, 0.22), (0.58, 0.33, 0.13), (0.95, 0.87, 0.68)
RYE, BUTTER, BUN = (0.40, 0.24, 0.13), (0.88, 0.62, 0.28), (0.72, 0.42, 0.16)
FLOUR = (0.95, 0.91, 0.82)

ROUND = (0, 90, 180, 270)
SIDES = 20  # of a round loaf
STEADY = 0.92  # share of the underside that is flat: a centre of mass 1.5 cm off must not tip it


def _bread_model(
    looks: tuple[Part, ...],
    hulls: tuple[Solid, ...],
    mass: float,
    grips: tuple[Array, ...],
    words: Words,
) -> AssetModel:
    return AssetModel(
        body=Body(looks, hulls, mass),
        material="bread",
        description=phrases(*words, "bread"),
        contact_points=grips,
        categories=("bread", "food"),
    )


def _baked(colour: Colour, name: str) -> Finish:
    return matt((1, 1, 1)).with_picture(crust(colour, name), "cylinder")


def _points(y: float, side: tuple[float, float] | None, yaws: tuple[int, ...]) -> tuple[Array, ...]:
    """Grasps from above at height `y`, and a horizontal one: `side` is its y and z direction."""
    above = from_above((0, y, 0), yaws)
    if side is None:
        return above
    return (*above, contact((0, side[0], 0), (0, 0, side[1]), (0, 1, 0)))


def round_loaf(
    radius: float, height: float, mass: float, colour: Colour, words: Words
) -> AssetModel:
    """A round loaf with a cross cut into it."""
    outline = [(STEADY, 0), (1.0, 0.22), (1.0, 0.52), (0.87, 0.74), (0.55, 0.92)]
    # Fingers must meet a face: held at two corners, a loaf would swing between them.
    reach = radius / np.cos(np.pi / SIDES)
    rings = [(float(reach * r), height * y) for r, y in outline]
    body = lathe([(0, 0), *rings, (0, height)], SIDES).turned("y", 180 / SIDES)
    crust_top = body.scaled(1.02).at(y=-0.0002)
    cut = crust_top & box(1.3 * radius, 0.4 * height, 0.12 * radius).at(y=0.9 * height)
    looks = (
        Part(body, _baked(colour, words[0]), "bread", 60),
        Part(cut + cut.turned("y", 90), matt(FLOUR), "bread"),
    )
    side = (0.6 * height, -1.0)
    yaw_height = {True: 0.0223, False: 0.0301}[height < 0.05]
    return _bread_model(looks, (body,), mass, _points(yaw_height, side, ROUND), words)


def long_loaf(
    size: tuple[float, float, float], along: str, mass: float, colour: Colour, words: Words
) -> AssetModel:
    """A small baguette with slanting cuts; sizes [m] across, up, along."""
    wide, high, length = size
    body = bread(wide, high, length, 0.25, flat=STEADY)
    scores, turn = scored(body, wide, high, length), 90 if along == "x" else 0
    looks = (
        Part(body.turned("y", turn), _baked(colour, words[0]), "bread", 60),
        Part(scores.turned("y", turn), matt(CRUMB), "bread"),
    )
    grips = _points(0.0186, None, (0, 180)) if turn else _points(0.0186, (0.018, 1.0), (90, 270))
    return _bread_model(looks, (body.turned("y", turn),), mass, grips, words)


def croissant(radius: float, thick: float, mass: float, words: Words) -> AssetModel:
    """A crescent of seven rolled segments in the ground plane, tips towards -z."""
    bounds = np.linspace(-125, 125, 8)
    segments = []
    for a, b in pairwise(bounds):
        middle = 0.5 * (a + b)
        ends = [_rolled(radius, angle, 0.82 * _girth(angle, thick)) for angle in (a, b)]
        segments.append(hull(np.vstack([*ends, _rolled(radius, middle, _girth(middle, thick))])))
    whole = together(*segments)
    shift = -0.5 * (whole.bounds[0] + whole.bounds[1])
    placed = [s.at(x=shift[0], z=shift[2]) for s in segments]
    looks = (Part(together(*placed), _baked(BUTTER, words[0]), "bread", 30),)
    return _bread_model(looks, tuple(placed), mass, _points(0.0236, (0.0123, -1.0), ROUND), words)


def _girth(angle_deg: float, thick: float) -> float:
    return thick * (0.42 + 0.58 * np.cos(np.deg2rad(angle_deg) * 0.72))


def _rolled(radius: float, angle_deg: float, girth: float) -> np.ndarray:
    """A flat-bottomed cross section of the crescent."""
    t = np.deg2rad(angle_deg)
    around = np.linspace(-0.2 * np.pi, 1.2 * np.pi, 9)
    out, up = 0.5 * girth * np.cos(around), 0.5 * girth * np.sin(around)
    up = np.maximum(up + 0.5 * girth * np.sin(0.2 * np.pi), 0.0)
    r = radius + out
    return np.stack([r * np.sin(t), up, r * np.cos(t)], axis=1)


def sliced(
    width: float, height: float, depth: float, lying: bool, mass: float, words: Words
) -> AssetModel:
    """Tin bread: a lying slice, or a standing piece with two cut faces."""
    shape = [(-0.44, 0), (0.44, 0), (0.44, 0.55), (0.5, 0.62), (0.5, 0.85), (0.36, 1.0)]
    shape += [(-x, y) for x, y in shape[:1:-1]]
    outline = rounded(np.array(shape) * (width, height), 0.006, 1)
    outline = outline - [0, 0.5 * height]
    core = rounded(0.90 * outline, 0.006, 1)
    slab = extrude(outline, depth - 0.0012).at(y=0.0006)
    crumb = extrude(core, depth)
    # The outline's second axis is z; standing, it is up.
    if not lying:
        slab, crumb = (s.turned("x", -90).at(y=0.5 * height, z=0.5 * depth) for s in (slab, crumb))
    face = matt((1, 1, 1)).with_picture(speckle(CRUMB, "crumb", 0.10), "y" if lying else "z")
    looks = (Part(slab, matt(BROWN), "bread"), Part(crumb, face, "bread"))
    grips = _points(0.0132 if lying else 0.0359, None, ROUND)
    return _bread_model(looks, (hull(together(slab, crumb).vertices),), mass, grips, words)


def baguette(width: float, height: float, length: float, mass: float, words: Words) -> AssetModel:
    """A long loaf along z. Clutter, without contact points."""
    body = bread(width, height, length, 0.35)
    looks = (
        Part(body, _baked(GOLD, words[0]), "bread", 60),
        Part(scored(body, width, height, length, 5), matt(CRUMB), "bread"),
    )
    return _bread_model(looks, (body,), mass, (), words)


MODELS: Models = {
    "075_bread": {
        0: partial(
            round_loaf, 0.0415, 0.0345, 0.085, GOLD,
            ("round loaf", "golden", "a cross on top"),
        ),
        1: partial(
            round_loaf, 0.0280, 0.0530, 0.045, BUN,
            ("bread roll", "brown", "a floury cross"),
        ),
        2: partial(croissant, 0.0175, 0.0360, 0.040, ("croissant", "buttery", "rolled ends")),
        3: partial(
            long_loaf, (0.0440, 0.0440, 0.0955), "z", 0.060, GOLD,
            ("small baguette", "golden", "slanting cuts"),
        ),
        4: partial(
            long_loaf, (0.0500, 0.0410, 0.0955), "x", 0.070, RYE,
            ("rye roll", "dark", "slanting cuts"),
        ),
        5: partial(
            sliced, 0.0610, 0.0620, 0.0660, False, 0.090,
            ("piece of tin bread", "brown", "pale cut faces"),
        ),
        6: partial(
            sliced, 0.0670, 0.0630, 0.0255, True, 0.040,
            ("slice of bread", "pale", "a brown crust"),
        ),
    },
    "054_baguette": {
        0: partial(
            baguette, 0.062, 0.055, 0.270, 0.20, ("baguette", "golden", "five slanting cuts")
        ),
        1: partial(
            baguette, 0.075, 0.060, 0.330, 0.28, ("big baguette", "long", "a cracked crust")
        ),
    },
}  # fmt: skip
