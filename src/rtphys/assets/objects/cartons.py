"""038_milk-box, 068_boxdrink and 023_tissue-box: household cardboard boxes."""

from dataclasses import dataclass
from functools import partial

from rtphys.assets.asset_model import AssetModel, Body, Part, contact, from_sides
from rtphys.assets.geometry import box, cylinder, tube
from rtphys.assets.labels import label
from rtphys.assets.material import Colour, Picture, matt, plastic
from rtphys.assets.objects import Models
from rtphys.assets.solid import Solid, hull
from rtphys.assets.words import Words, phrases


@dataclass(frozen=True)
class Carton:
    """Outer sizes [m] and mass [kg]."""

    x: float
    y: float
    z: float
    mass: float


@dataclass(frozen=True)
class Print:
    """The label's three colours, its style and the cap's colour."""

    ground: Colour
    accent: Colour
    ink: Colour
    style: str
    cap: Colour


def milk_box(size: Carton, look: Print, words: Words) -> AssetModel:
    """A gable-topped carton with a screw cap on its slope."""
    roof = 0.22 * size.y
    body = size.y - roof - 0.012
    block = box(size.x, body, size.z).at(y=0.5 * body)
    ridge = box(size.x, 0.001, 0.003).at(y=body + roof)
    gable = hull([*box(size.x, 0.001, size.z).at(y=body).vertices, *ridge.vertices])
    fin = box(size.x, 0.014, 0.003).at(y=size.y - 0.007)
    cap = cylinder(0.011, 0.014, 16).turned("x", 52).at(0, body + 0.5 * roof, 0.27 * size.z)
    paper = matt((1, 1, 1)).with_picture(_print(look), "cylinder")
    plain = matt(look.ground)
    looks = (
        Part(block, paper, "cardboard"),
        Part(gable + fin, plain, "cardboard"),
        Part(cap, plastic(look.cap, 0.4)),
    )
    return AssetModel(
        body=Body(looks, (block, gable, fin, hull(cap.vertices)), size.mass),
        material="cardboard",
        description=phrases(*words, "carton"),
        categories=("milk box", "drink"),
    )


def drink_box(size: Carton, look: Print, straw: float, words: Words) -> AssetModel:
    """A brick of juice with a bent straw, `straw` [m] tall."""
    high = size.y - straw
    block = box(size.x, high, size.z).at(y=0.5 * high)
    bend = (0.2 * size.x, high + 0.6 * straw, 0)
    path = [(0.2 * size.x, high - 0.01, 0), bend, (-0.05 * size.x, high + straw - 0.003, 0)]
    straws: tuple[Solid, ...] = ()
    looks = [Part(block, matt((1, 1, 1)).with_picture(_print(look), "cylinder"), "cardboard")]
    if straw > 0:
        straws = tuple(hull(tube(path[i : i + 2], 0.0025, 6).vertices) for i in range(2))
        looks.append(Part(tube(path, 0.0025, 6), plastic(look.cap, 0.4)))
    return AssetModel(
        body=Body(tuple(looks), (block, *straws), size.mass),
        material="cardboard",
        description=phrases(*words, "drink carton"),
        contact_points=from_sides(0.5 * high, (270, 0, 90, 180)),
        categories=("box drink", "drink"),
    )


def tissue_box(size: Carton, look: Print, words: Words) -> AssetModel:
    """A flat box with a tissue sticking out of its top."""
    high = size.y - 0.016
    block = box(size.x, high, size.z).at(y=0.5 * high)
    long = max(size.x, size.z)
    slot = box(0.55 * size.x, 0.001, 0.5 * size.z).at(y=high)
    fold = 0.45 * min(size.x, size.z)
    foot = [(s * 0.5 * fold, high - 0.001, t * 0.006) for s in (-1, 1) for t in (-1, 1)]
    tips = [(-0.3 * fold, size.y - 0.004, 0.001), (0.1 * fold, size.y, -0.004)]
    tissue = hull([*foot, *tips, (0.42 * fold, size.y - 0.007, 0.003)])
    looks = (
        Part(block, matt((1, 1, 1)).with_picture(_print(look), "cylinder"), "cardboard"),
        Part(slot, matt(look.cap), "paper"),
        Part(tissue, matt((0.97, 0.97, 0.97)), "paper"),
    )
    out = (1.0, 0.0, 0.0) if long == size.x else (0.0, 0.0, 1.0)
    ends = [
        contact((s * 0.5 * long * out[0], 0.35 * size.y, s * 0.5 * long * out[2]),
                (s * out[0], 0, s * out[2]), (0, 1, 0))
        for s in (-1, 1)
    ]  # fmt: skip
    return AssetModel(
        body=Body(looks, (block, tissue), size.mass),
        material="cardboard",
        description=phrases(*words, "paper tissues"),
        contact_points=tuple(ends),
        categories=("tissue box", "household"),
    )


def _print(look: Print) -> Picture:
    return label(look.ground, look.accent, look.ink, look.style)


WHITE, BLUE, GREEN = (0.95, 0.95, 0.93), (0.12, 0.36, 0.74), (0.22, 0.58, 0.30)
RED, BROWN, YELLOW = (0.80, 0.14, 0.12), (0.42, 0.24, 0.12), (0.97, 0.80, 0.18)
PINK, ORANGE, PURPLE = (0.95, 0.68, 0.76), (0.95, 0.52, 0.12), (0.45, 0.28, 0.60)
SKY, MINT, BLACK = (0.62, 0.82, 0.94), (0.70, 0.88, 0.80), (0.14, 0.14, 0.15)

MODELS: Models = {
    "038_milk-box": {
        0: partial(
            milk_box,
            Carton(0.062, 0.121, 0.062, 0.26),
            Print(WHITE, BLUE, BLUE, "wave", BLUE),
            ("milk box", "white and blue", "a blue cap"),
        ),
        2: partial(
            milk_box,
            Carton(0.078, 0.215, 0.078, 0.55),
            Print(GREEN, WHITE, GREEN, "badge", WHITE),
            ("milk box", "green", "a white cap"),
        ),
        3: partial(
            milk_box,
            Carton(0.070, 0.190, 0.070, 0.42),
            Print(PINK, RED, WHITE, "fruit", RED),
            ("strawberry milk box", "pink", "a red cap"),
        ),
        4: partial(
            milk_box,
            Carton(0.070, 0.170, 0.070, 0.36),
            Print(BROWN, YELLOW, WHITE, "band", YELLOW),
            ("chocolate milk box", "brown", "a yellow cap"),
        ),
    },
    "068_boxdrink": {
        0: partial(
            drink_box,
            Carton(0.076, 0.154, 0.077, 0.30),
            Print(ORANGE, GREEN, WHITE, "fruit", WHITE),
            0.040, ("juice box", "orange", "a white straw"),
        ),
        1: partial(
            drink_box,
            Carton(0.078, 0.203, 0.078, 0.45),
            Print(PURPLE, GREEN, WHITE, "fruit", RED),
            0.050, ("grape juice box", "purple", "a red straw"),
        ),
        2: partial(
            drink_box,
            Carton(0.074, 0.243, 0.074, 0.50),
            Print(SKY, WHITE, BLUE, "wave", WHITE),
            0.0, ("oat drink carton", "light blue", "a white wave"),
        ),
        3: partial(
            drink_box,
            Carton(0.063, 0.203, 0.049, 0.35),
            Print(YELLOW, RED, RED, "blocks", BLACK),
            0.035, ("lemon tea box", "yellow", "a black straw"),
        ),
    },
    "023_tissue-box": {
        0: partial(
            tissue_box,
            Carton(0.115, 0.063, 0.067, 0.10),
            Print(SKY, WHITE, BLUE, "wave", BLUE),
            ("tissue box", "light blue", "a white wave"),
        ),
        1: partial(
            tissue_box,
            Carton(0.153, 0.099, 0.089, 0.18),
            Print(MINT, GREEN, WHITE, "fruit", GREEN),
            ("tissue box", "mint green", "green dots"),
        ),
        3: partial(
            tissue_box,
            Carton(0.073, 0.077, 0.115, 0.11),
            Print(WHITE, PINK, RED, "badge", PINK),
            ("tissue box", "white", "pink ovals"),
        ),
        5: partial(
            tissue_box,
            Carton(0.115, 0.092, 0.071, 0.12),
            Print(BROWN, YELLOW, WHITE, "band", BLACK),
            ("tissue box", "brown", "a yellow stripe"),
        ),
    },
}  # fmt: skip
