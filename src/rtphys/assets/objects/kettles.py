"""091_kettle and 087_waterer: a spout towards +z and a handle, above or behind."""

from functools import partial

from rtphys.assets.asset_model import AssetModel, Body, Part, contact, functional
from rtphys.assets.bottle import with_handle
from rtphys.assets.geometry import ball, lathe, tube
from rtphys.assets.material import Colour, metal, plastic
from rtphys.assets.objects import Models
from rtphys.assets.solid import Solid, hull
from rtphys.assets.turned import turned_parts
from rtphys.assets.vessel import Vessel
from rtphys.assets.words import Words, phrases

Point = tuple[float, float, float]


def kettle(
    belly: tuple[tuple[float, float], ...],
    spout: tuple[Point, Point],
    grip: Point,
    colours: tuple[Colour, Colour],
    words: Words,
) -> AssetModel:
    """A turned belly (radius, y) with a lid, a conical spout and a bail over it.

    The bail runs along z; `grip` is its highest point, where the contact point is.
    """
    shell, dark = metal(colours[0], 0.3), plastic(colours[1], 0.3)
    top, radius = belly[-1][1], belly[-1][0]
    wide = max(r for r, _ in belly)
    outline = [(0, 0), *belly, (0.4 * radius, top + 0.010), (0, top + 0.012)]
    knob = ball(0.012, 10).at(y=top + 0.019)
    beak = _beak(*spout)
    body = Body(
        (
            Part(lathe(outline, 24) + beak, shell, "steel", 40),
            Part(knob, dark),
        ),
        (*turned_parts(outline), hull(beak.vertices), knob),
        0.75,
    )
    foot = 0.72 * top
    reach = 0.80 * wide
    bail = [(0, foot, -reach), (0, grip[1] - 0.012, -0.72 * reach), (0, grip[1], grip[2] - 0.028)]
    bail += [(0, grip[1], grip[2] + 0.028), (0, grip[1] - 0.012, 0.55 * reach), (0, foot, reach)]
    return AssetModel(
        body=with_handle(body, bail, dark),
        material="steel",
        description=phrases(*words, "tea kettle"),
        contact_points=(contact(grip, (0, 1, 0), (0, 0, 1)),),
        categories=("kettle", "kitchen"),
    )


def watering_can(
    size: Vessel, tip: Point, grip: Point, colours: tuple[Colour, Colour], words: Words
) -> AssetModel:
    """An open can with a long spout ending in a rose, and a handle behind."""
    can, trim = plastic(colours[0], 0.4), plastic(colours[1], 0.4)
    r, top = size.outer[-1]
    pipe = ((0, 0.25 * top, 0.9 * r), tip)
    spout = _beak(*pipe, wide=0.010, narrow=0.006)
    rose = lathe([(0, 0), (0.007, 0), (0.018, 0.014), (0, 0.016)], 12).turned("x", 45).at(*tip)
    body = Body(
        (
            Part(size.shell(), can, crease_deg=50),
            Part(spout + rose, trim),
        ),
        (*size.parts(), hull(spout.vertices), hull(rose.vertices)),
        0.24,
    )
    behind = [(0, 0.9 * top, -0.95 * r), (0, 0.85 * top, grip[2])]
    behind += [(0, 0.30 * top, grip[2]), (0, 0.2 * top, -0.9 * r)]
    return AssetModel(
        body=with_handle(body, behind, trim),
        material="plastic",
        description=phrases(*words, "watering pot"),
        contact_points=(contact(grip, (0, 0, -1), (0, 1, 0)),),
        functional_points=(functional(tip, (0, 0.7, 0.7), (1, 0, 0)),),
        categories=("watering can", "household"),
    )


def _beak(start: Point, end: Point, wide: float = 0.016, narrow: float = 0.008) -> Solid:
    """A cone from belly to tip."""
    thick, thin = tube([start, end], wide, 8), tube([start, end], narrow, 8)
    half = len(thick.vertices) // 2 - 1  # the two end points are last
    return hull([*thick.vertices[:half], *thin.vertices[half:-2]])


STEEL, RED, BLACK = (0.76, 0.77, 0.80), (0.74, 0.14, 0.12), (0.12, 0.12, 0.13)
MINT, BROWN, GREEN = (0.62, 0.80, 0.72), (0.42, 0.26, 0.15), (0.24, 0.52, 0.30)
BLUE, YELLOW = (0.25, 0.48, 0.75), (0.94, 0.76, 0.20)

MODELS: Models = {
    "091_kettle": {
        0: partial(
            kettle,
            ((0.070, 0.0), (0.082, 0.012), (0.084, 0.045), (0.055, 0.095)),
            ((0, 0.045, 0.065), (0, 0.100, 0.118)), (0.0005, 0.1740, -0.0150), (STEEL, BLACK),
            ("kettle", "silver", "a black handle"),
        ),
        2: partial(
            kettle,
            ((0.078, 0.0), (0.086, 0.010), (0.072, 0.065), (0.048, 0.110)),
            ((0, 0.040, 0.066), (0, 0.105, 0.122)), (0.0005, 0.1641, -0.0217), (RED, BLACK),
            ("kettle", "red", "a short spout"),
        ),
        4: partial(
            kettle,
            ((0.060, 0.0), (0.068, 0.020), (0.066, 0.075), (0.045, 0.115)),
            ((0, 0.050, 0.055), (0, 0.118, 0.098)), (0.0005, 0.1833, -0.0070), (MINT, BROWN),
            ("kettle", "mint green", "a brown handle"),
        ),
    },
    "087_waterer": {
        0: partial(
            watering_can, Vessel(((0.050, 0.0), (0.050, 0.085)), 0.003, 0.004, 20),
            (0, 0.0820, 0.0850), (0.0012, 0.0412, -0.0933), (GREEN, YELLOW),
            ("watering can", "green", "a yellow spout"),
        ),
        1: partial(
            watering_can, Vessel(((0.056, 0.0), (0.046, 0.095)), 0.003, 0.004, 20),
            (0, 0.0800, 0.0860), (0.0012, 0.0500, -0.0933), (BLUE, BLUE),
            ("watering can", "blue", "a long spout"),
        ),
    },
}  # fmt: skip
