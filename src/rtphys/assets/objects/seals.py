"""100_seal: stamps, a block with a knob or a carved top, held by its upper part."""

from dataclasses import dataclass
from functools import partial

from rtphys.assets.asset_model import AssetModel, Body, Part, from_above, from_sides
from rtphys.assets.geometry import box, cone, lathe, rounded, rounded_box
from rtphys.assets.material import Colour, Finish, matt, metal, plastic
from rtphys.assets.objects import Models
from rtphys.assets.pictures import grain
from rtphys.assets.solid import Solid, hull

RUBBER = 0.004  # [m] thickness of the printing face
INK = plastic((0.75, 0.10, 0.10), 0.3)


@dataclass(frozen=True)
class Seal:
    """Sizes [m]: foot, height, share of it that is block; grasp heights; mass [kg]."""

    x: float
    z: float
    height: float
    block: float
    aside: float
    above: float
    mass: float


def knobbed(size: Seal, wood: Finish, knob: Finish, words: tuple[str, ...]) -> AssetModel:
    """A block with a turned handle."""
    top, r = size.height, 0.42 * min(size.x, size.z)
    low = size.block * top
    outline = [
        (0, low - 0.002),
        (0.52 * r, low - 0.002),
        (0.44 * r, low + 0.28 * (top - low)),
        (r, low + 0.62 * (top - low)),
        (0.80 * r, top - 0.004),
        (0, top),
    ]
    handle = lathe(rounded(outline, 0.3 * r, 3, closed=False), 16)
    neck = cone(0.52 * r, 0.52 * r, 0.40 * (top - low), 12).at(y=low - 0.002)
    head = hull([v for v in handle.vertices if v[1] > low + 0.30 * (top - low)])
    return _thing(size, (Part(handle, knob, "wood", 50),), wood, (neck, head), words)


def carved(size: Seal, stone: Finish, crown: Finish, words: tuple[str, ...]) -> AssetModel:
    """A stone whose upper part narrows to a little carved roof."""
    low, top = size.block * size.height, size.height
    neck = box(0.66 * size.x, 0.3 * (top - low), 0.66 * size.z).at(y=low + 0.14 * (top - low))
    roof = hull([
        *box(0.92 * size.x, 0.004, 0.92 * size.z).at(y=low + 0.30 * (top - low)).vertices,
        *box(0.86 * size.x, 0.004, 0.86 * size.z).at(y=low + 0.50 * (top - low)).vertices,
        *box(0.34 * size.x, 0.004, 0.34 * size.z).at(y=top - 0.002).vertices,
    ])  # fmt: skip
    return _thing(size, (Part(neck + roof, crown, "ceramic"),), stone, (neck, roof), words)


def slim(size: Seal, stone: Finish, cap: Finish, words: tuple[str, ...]) -> AssetModel:
    """An upright bar with a rounded top."""
    low, top = size.block * size.height, size.height
    bar = rounded_box(0.90 * size.x, top - low + 0.004, 0.90 * size.z, 0.3 * size.z, 2)
    bar = bar.at(y=(top + low - 0.004) / 2)
    return _thing(size, (Part(bar, cap, "ceramic", 50),), stone, (bar,), words)


def _thing(
    size: Seal,
    upper: tuple[Part, ...],
    finish: Finish,
    hulls: tuple[Solid, ...],
    words: tuple[str, ...],
) -> AssetModel:
    low = size.block * size.height
    block = rounded_box(size.x, low - RUBBER + 0.001, size.z, 0.002, 1)
    block = block.at(y=(low + RUBBER - 0.001) / 2)
    face = box(0.94 * size.x, RUBBER, 0.94 * size.z).at(y=RUBBER / 2)
    band = box(1.01 * size.x, 0.003, 1.01 * size.z).at(y=RUBBER + 0.003)
    looks = (
        Part(block, finish, "wood"),
        Part(face + band, INK, "rubber"),
        *upper,
    )
    # The official order of sides: from -x, +z, +x, -z.
    points = from_sides(size.aside, (270, 0, 90, 180)) + from_above((0, size.above, 0))
    return AssetModel(
        body=Body(looks, (block, face, *hulls), size.mass),
        material="rubber",
        description=words,
        contact_points=points,
        categories=("seal", "office"),
    )


BEECH = matt((0.84, 0.66, 0.44)).with_picture(grain((1.0, 1.0, 1.0), "seal beech", 0.14), "z")
WALNUT = plastic((0.36, 0.20, 0.11), 0.6)
JADE, JADE_DARK = plastic((0.42, 0.68, 0.52), 0.8), plastic((0.28, 0.52, 0.38), 0.8)
RED_STONE = plastic((0.62, 0.22, 0.16), 0.7)
BLACK, BRASS = plastic((0.10, 0.10, 0.11), 0.7), metal((0.86, 0.68, 0.28), 0.3)
BLUE: Colour = (0.15, 0.28, 0.58)

MODELS: Models = {
    "100_seal": {
        0: partial(
            knobbed,
            Seal(0.0545, 0.0545, 0.0960, 0.42, 0.0702, 0.0702, 0.135),
            BEECH,
            WALNUT,
            ("wooden stamp", "stamp with a dark knob", "big wooden seal", "rubber stamp"),
        ),
        2: partial(
            slim,
            Seal(0.0355, 0.0318, 0.0775, 0.30, 0.0424, 0.0420, 0.120),
            RED_STONE,
            RED_STONE,
            ("red stone seal", "slim red seal", "red name stamp", "small red seal"),
        ),
        3: partial(
            carved,
            Seal(0.0484, 0.0484, 0.0770, 0.46, 0.0532, 0.0522, 0.210),
            JADE,
            JADE_DARK,
            ("jade seal", "green stone seal", "green stamp", "carved green seal"),
        ),
        4: partial(
            slim,
            Seal(0.0378, 0.0262, 0.0770, 0.24, 0.0500, 0.0481, 0.110),
            BLACK,
            BRASS,
            ("black and gold seal", "narrow seal", "golden stamp", "seal with a golden handle"),
        ),
        6: partial(
            knobbed,
            Seal(0.0562, 0.0562, 0.0770, 0.40, 0.0549, 0.0517, 0.145),
            plastic(BLUE, 0.6),
            BLACK,
            ("blue stamp", "office stamp", "blue and black seal", "stamp with a black knob"),
        ),
    }
}
