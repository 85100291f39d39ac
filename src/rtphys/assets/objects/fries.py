"""005_french-fries: a carton of fries. It spawns lying on its back (z up); it can also stand."""

from dataclasses import dataclass
from functools import partial

from rtphys.assets.asset_model import AssetModel, Body, Part, contact, functional
from rtphys.assets.geometry import box
from rtphys.assets.labels import label
from rtphys.assets.material import Colour, matt
from rtphys.assets.objects import Models
from rtphys.assets.solid import Solid, hull, together
from rtphys.assets.words import Words, phrases
from rtphys.core.seeds import stream


@dataclass(frozen=True)
class Fries:
    """Sizes [m]: y runs from the carton's foot to the tips."""

    foot: float  # width
    mouth: float  # width
    depth: float  # thickness
    carton: float  # height
    height: float  # to the tips
    grip: tuple[float, float]  # y, z of the contact points
    below: tuple[float, float, float]  # the functional point
    mass: float  # [kg]


def fries(size: Fries, ground: Colour, accent: Colour, words: Words) -> AssetModel:
    """A flat carton, wider at its mouth, with sticks in it; its middle plane is z = 0."""
    half = 0.5 * size.depth
    low = [(s * 0.5 * size.foot, 0.0, z) for s in (-1, 1) for z in (-half, half)]
    back = [(s * 0.5 * size.mouth, size.carton, -half) for s in (-1, 1)]
    front = [(s * 0.47 * size.mouth, 0.84 * size.carton, half) for s in (-1, 1)]
    carton = hull([*low, *back, *front])
    paper = matt((1, 1, 1)).with_picture(label(ground, accent, accent, "wave"), "z")
    sticks, block = _sticks(size)
    y, z = size.grip
    return AssetModel(
        body=Body(
            (
                Part(carton, paper, "cardboard"),
                Part(sticks, matt((0.96, 0.78, 0.30)), "food"),
            ),
            (carton, block),
            size.mass,
        ),
        material="cardboard",
        description=phrases(*words, "fast food"),
        contact_points=tuple(contact((0, y, z), (0, 0, 1), (0, s, 0)) for s in (1, -1)),
        functional_points=(functional(size.below, (0, 0, -1), (1, 0, 0)),),
        categories=("french fries", "food"),
    )


def _sticks(size: Fries) -> tuple[Solid, Solid]:
    """Fourteen sticks in two rows that stand out of the carton, and the block they fill."""
    rng = stream(0, "assets", "fries", str(size.height))
    sticks = []
    for row, z in ((0, -0.20 * size.depth), (1, 0.20 * size.depth)):
        for i in range(7):
            share = (i - 3) / 3
            top = size.height - (0.02 if row else 0.0) * rng.random() - 0.006 * abs(share)
            top -= 0.012 * rng.random()
            long = top - 0.4 * size.carton
            stick = box(0.0075, long, 0.0075).turned("y", 40 * rng.random())
            lean = stick.at(y=0.5 * long).turned("z", -8 * share)
            sticks.append(lean.at(share * 0.36 * size.foot, 0.4 * size.carton, z))
    heap = together(*sticks)
    # The tallest stick reaches the official height.
    heap = heap.at(y=size.height - heap.bounds[1][1])
    return heap, hull(heap.vertices)


RED, YELLOW, BLUE = (0.82, 0.10, 0.08), (0.98, 0.80, 0.15), (0.15, 0.35, 0.75)
GREEN, CREAM, WHITE = (0.20, 0.52, 0.30), (0.96, 0.90, 0.76), (0.95, 0.95, 0.93)

MODELS: Models = {
    "005_french-fries": {
        0: partial(
            fries,
            Fries(
                0.046, 0.069, 0.031, 0.066, 0.0955, (0.0269, -0.0045),
                (-0.0004, 0.0273, -0.0028), 0.11,
            ),
            RED, YELLOW, ("french fries", "red", "a red carton"),
        ),
        1: partial(
            fries,
            Fries(
                0.040, 0.054, 0.030, 0.056, 0.0920, (0.0258, -0.0043),
                (0.0033, 0.0242, -0.0036), 0.08,
            ),
            BLUE, WHITE, ("french fries", "blue", "a blue carton"),
        ),
        2: partial(
            fries,
            Fries(
                0.058, 0.080, 0.025, 0.052, 0.0805, (0.0231, -0.0038),
                (0.0015, 0.0224, -0.0054), 0.10,
            ),
            GREEN, CREAM, ("french fries", "green", "a wide carton"),
        ),
    }
}  # fmt: skip
