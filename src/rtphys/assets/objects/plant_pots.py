"""012_plant-pot: potted plants. Clutter, without contact points: foliage cannot be grasped."""

from dataclasses import dataclass
from functools import partial

import numpy as np

from rtphys.assets.asset_model import AssetModel, Body, Part
from rtphys.assets.geometry import cylinder
from rtphys.assets.material import Colour, matt, plastic
from rtphys.assets.objects import Models
from rtphys.assets.rounded_tray import RoundedTray
from rtphys.assets.solid import Solid, hull, together
from rtphys.assets.words import Words, phrases
from rtphys.core.seeds import stream


@dataclass(frozen=True)
class Plant:
    """Sizes [m]: a ring of leaves around every stem, `count` in all, leaning by up to `lean`."""

    stems: tuple[float, ...]  # x of the stems
    length: float
    width: float
    count: int  # leaves a stem
    lean_deg: float  # of the outermost


def potted(
    pot: RoundedTray, mass: float, plant: Plant, colours: tuple[Colour, Colour], words: Words
) -> AssetModel:
    """A pot full of soil with a plant in it."""
    glaze, green = colours
    soil = 0.88 * pot.y
    filled = RoundedTray(pot.x, pot.y, pot.z, pot.base, 0.004, soil, pot.corner, pot.steps)
    earth = filled.liner(0.002)
    leaves = [
        leaf.at(x, soil)
        for x in plant.stems
        for leaf in _leaves(plant, f"{words[0]} {words[1]} {x}")
    ]
    foliage = together(*leaves)
    crown = hull(foliage.vertices[foliage.vertices[:, 1] > soil + 0.001])
    looks = (
        Part(filled.shell() + filled.rim(0.002, 0.010), plastic(glaze, 0.3), "ceramic"),
        Part(earth, matt((0.24, 0.16, 0.10)), "food"),
        Part(foliage, matt(green), "food", 10),
    )
    return AssetModel(
        body=Body(looks, (*filled.parts(), *filled.rim_parts(0.002, 0.010), crown), mass),
        material="ceramic",
        description=phrases(*words, "potted plant"),
        categories=("plant pot", "household"),
    )


def _leaves(plant: Plant, name: str) -> list[Solid]:
    """Leaves from vertical ones in the middle to leaning ones outside, in golden-angle order."""
    rng = stream(0, "assets", "plant", name)
    leaves = []
    for i in range(plant.count):
        share = np.sqrt((i + 0.5) / plant.count)
        long = plant.length * (1 - 0.35 * share) * (0.9 + 0.2 * rng.random())
        leaf = _leaf(long, plant.width)
        leaves.append(leaf.turned("z", -plant.lean_deg * share).turned("y", 137.5 * i))
    return leaves


def _leaf(length: float, width: float) -> Solid:
    middle = 0.45 * length
    across = [(0.0, middle, s * 0.5 * width) for s in (-1, 1)]
    thick = [(s * 0.12 * width, middle, 0.0) for s in (-1, 1)]
    return hull([(0.0, -0.004, 0.0), (0.0, length, 0.0), *across, *thick])


def cactus(pot: RoundedTray, mass: float, height: float, words: Words) -> AssetModel:
    """A ribbed column with two arms in a clay pot."""
    soil = 0.88 * pot.y
    filled = RoundedTray(pot.x, pot.y, pot.z, pot.base, 0.004, soil, pot.corner, pot.steps)
    trunk = _column(0.021, height).at(y=soil)
    arms = [
        _column(0.011, 0.35 * height).at(s * 0.036, soil + (0.40 + 0.12 * s) * height)
        for s in (-1, 1)
    ]
    links = [
        cylinder(0.009, 0.036, 8).turned("z", 90).at(s * 0.022, soil + (0.42 + 0.12 * s) * height)
        for s in (-1, 1)
    ]
    green = matt((0.30, 0.52, 0.26))
    looks = (
        Part(
            filled.shell() + filled.rim(0.003, 0.012), plastic((0.74, 0.38, 0.24), 0.2), "ceramic"
        ),
        Part(filled.liner(0.002), matt((0.70, 0.60, 0.42)), "food"),
        Part(together(trunk, *arms, *links), green, "food", 20),
    )
    pot_parts = (*filled.parts(), *filled.rim_parts(0.003, 0.012))
    hulls = (*pot_parts, *(hull(s.vertices) for s in (trunk, *arms, *links)))
    return AssetModel(
        body=Body(looks, hulls, mass),
        material="ceramic",
        description=phrases(*words, "potted plant"),
        categories=("plant pot", "household"),
    )


def _column(radius: float, height: float) -> Solid:
    """Convex, rounded at the top, eight-sided."""
    levels = [
        (1.0, 0.0),
        (1.0, height - 0.9 * radius),
        (0.75, height - 0.3 * radius),
        (0.3, height),
    ]
    angles = 2 * np.pi * np.arange(10) / 10
    return hull(
        [(radius * r * np.cos(a), y, radius * r * np.sin(a)) for r, y in levels for a in angles]
    )


CLAY, WHITE, BLUE = (0.74, 0.38, 0.24), (0.92, 0.91, 0.88), (0.28, 0.42, 0.62)
GREY, YELLOW = (0.52, 0.54, 0.55), (0.90, 0.72, 0.26)
FRESH, DEEP, PALE = (0.36, 0.62, 0.22), (0.16, 0.40, 0.20), (0.55, 0.68, 0.48)

MODELS: Models = {
    "012_plant-pot": {
        0: partial(
            potted, RoundedTray(0.105, 0.090, 0.105, 0.72, 0.004, 0.005, 0.0525, 3), 0.45,
            Plant((0.0,), 0.095, 0.024, 16, 62), (CLAY, FRESH),
            ("house plant", "green", "a clay pot"),
        ),
        1: partial(
            potted, RoundedTray(0.182, 0.042, 0.085, 0.88, 0.004, 0.005, 0.010), 0.48,
            Plant((-0.055, 0.0, 0.055), 0.036, 0.026, 9, 72), (WHITE, PALE),
            ("succulents", "pale green", "a long white pot"),
        ),
        2: partial(
            potted, RoundedTray(0.120, 0.085, 0.120, 0.80, 0.004, 0.005, 0.012), 0.62,
            Plant((0.0,), 0.090, 0.034, 14, 75), (BLUE, DEEP),
            ("house plant", "dark green", "a blue pot"),
        ),
        3: partial(
            cactus, RoundedTray(0.092, 0.080, 0.092, 0.74, 0.004, 0.005, 0.046, 3), 0.40, 0.130,
            ("cactus", "green", "two arms"),
        ),
        4: partial(
            potted, RoundedTray(0.182, 0.045, 0.080, 0.92, 0.004, 0.005, 0.006), 0.50,
            Plant((-0.06, -0.02, 0.02, 0.06), 0.032, 0.018, 7, 60), (YELLOW, FRESH),
            ("herbs", "fresh green", "a long yellow pot"),
        ),
    }
}  # fmt: skip
