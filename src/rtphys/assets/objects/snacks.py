"""025_chips-tub, 101_milk-tea, 133_ramen-bowl and 134_snack-bag: packed food and drink."""

from functools import partial

from rtphys.assets.asset_model import AssetModel, Body, Part, from_sides
from rtphys.assets.geometry import box, tube
from rtphys.assets.labels import label
from rtphys.assets.material import Colour, Finish, matt, metal, plastic
from rtphys.assets.objects import Models
from rtphys.assets.solid import hull
from rtphys.assets.turned import disc, ring, turned, turned_parts
from rtphys.assets.words import Words, phrases

Colours = tuple[Colour, Colour, Colour]  # of a label


def chips_tub(
    radius: float, height: float, print_: Colours, style: str, words: Words
) -> AssetModel:
    """A tall paper tube with a plastic lid."""
    tubular = [(0, 0), (radius, 0), (radius, height - 0.008), (0, height - 0.008)]
    lid = disc(1.03 * radius, height - 0.012, height)
    looks = (
        Part(turned(tubular), metal(), "cardboard"),
        Part(ring(radius + 0.0004, 0.004, height - 0.013), _paper(print_, style), "paper"),
        Part(lid, plastic((0.93, 0.93, 0.90), 0.4)),
    )
    hulls = (*turned_parts(tubular), lid)
    return _food(Body(looks, hulls, 0.19), "cardboard", phrases(*words, "snack tube"), "chips tub")


def milk_tea(
    foot: float, rim: float, height: float, grip: float, tea: Colour, words: Words
) -> AssetModel:
    """A plastic cup of tea with pearls, a flat lid and a thick straw."""
    cup = 0.74 * height
    outline = [(0, 0), (foot, 0), (rim, cup), (0, cup)]
    lid = disc(1.03 * rim, cup - 0.002, cup + 0.008)
    straw = tube([(0, cup, 0), (0.012, height - 0.001, 0)], 0.005, 8)
    pearls = ring(foot + (rim - foot) * 0.12 + 0.0004, 0.004, 0.20 * cup, 0.004)
    looks = (
        Part(turned(outline), plastic(tea, 0.6)),
        Part(pearls, matt((0.16, 0.10, 0.08)), "food"),
        Part(lid + ring(foot + (rim - foot) * 0.86 + 0.003, 0.80 * cup, 0.92 * cup, 0.006),
             plastic((0.93, 0.94, 0.94), 0.7)),
        Part(straw, plastic((0.90, 0.35, 0.45), 0.5)),
    )  # fmt: skip
    model = _food(
        Body(looks, (*turned_parts(outline), lid, hull(straw.vertices)), 0.35),
        "plastic",
        phrases(*words, "bubble tea"),
        "milk tea",
    )
    sides = from_sides(grip, (270, 315, 0, 45, 90, 135, 180, 225))
    return AssetModel(model.body, model.material, model.description, sides, (), model.categories)


def ramen(foot: float, rim: float, height: float, print_: Colours, words: Words) -> AssetModel:
    """A paper bowl of instant noodles with a foil lid."""
    outline = [(0, 0), (foot, 0), (rim, height - 0.004), (0, height - 0.004)]
    lid = disc(1.04 * rim, height - 0.005, height)
    flap = box(0.03, 0.0015, 0.02).at(0, height - 0.001, rim + 0.002)
    looks = (
        Part(turned(outline), _paper(print_, "badge"), "paper"),
        Part(lid + flap, metal((0.86, 0.84, 0.80), 0.3), "paper"),
    )
    hulls = (*turned_parts(outline), lid, flap)
    return _food(Body(looks, hulls, 0.12), "paper", phrases(*words, "instant noodles"), "ramen")


def snack_bag(x: float, z: float, thick: float, print_: Colours, words: Words) -> AssetModel:
    """A pillow pack that lies; sealed ends at +-z, flat underneath."""
    base = [(s * 0.36 * x, 0.0, t * 0.30 * z) for s in (-1, 1) for t in (-1, 1)]
    top = [(s * 0.26 * x, thick, t * 0.22 * z) for s in (-1, 1) for t in (-1, 1)]
    flank = [(s * 0.5 * x, 0.42 * thick, t * 0.26 * z) for s in (-1, 1) for t in (-1, 1)]
    ends = [(s * 0.47 * x, 0.40 * thick, t * 0.46 * z) for s in (-1, 1) for t in (-1, 1)]
    pillow = hull([*base, *top, *flank, *ends])
    seals = [box(0.94 * x, 0.0015, 0.06 * z).at(0, 0.40 * thick, t * 0.47 * z) for t in (-1, 1)]
    shiny = plastic((1, 1, 1), 0.8).with_picture(label(*print_, "badge"), "y")
    looks = (
        Part(pillow, shiny, "paper", 10),
        Part(seals[0] + seals[1], plastic(print_[1], 0.7), "paper"),
    )
    hulls = (pillow, *seals)
    return _food(Body(looks, hulls, 0.06), "plastic", phrases(*words, "snack packet"), "snack bag")


def _paper(colours: Colours, style: str) -> Finish:
    return plastic((1, 1, 1), 0.3).with_picture(label(*colours, style), "cylinder")


def _food(body: Body, material: str, words: tuple[str, ...], category: str) -> AssetModel:
    return AssetModel(body, material, words, categories=(category, "food"))


RED, GREEN, BLUE = (0.80, 0.12, 0.10), (0.20, 0.55, 0.25), (0.12, 0.34, 0.72)
WHITE, YELLOW, BLACK = (0.95, 0.95, 0.93), (0.97, 0.80, 0.15), (0.12, 0.11, 0.11)
ORANGE, PURPLE, CREAM = (0.95, 0.50, 0.10), (0.45, 0.22, 0.55), (0.96, 0.90, 0.74)
TEA, MATCHA, TARO = (0.76, 0.56, 0.38), (0.62, 0.74, 0.42), (0.74, 0.62, 0.80)

MODELS: Models = {
    "025_chips-tub": {
        0: partial(
            chips_tub, 0.0375, 0.200, (RED, YELLOW, WHITE), "badge",
            ("tube of chips", "red", "a yellow oval"),
        ),
        1: partial(
            chips_tub, 0.0360, 0.235, (GREEN, WHITE, GREEN), "wave",
            ("tube of chips", "green", "a white wave"),
        ),
        2: partial(
            chips_tub, 0.0350, 0.150, (PURPLE, ORANGE, WHITE), "band",
            ("short tube of chips", "purple", "an orange band"),
        ),
    },
    "101_milk-tea": {
        0: partial(
            milk_tea, 0.030, 0.0440, 0.1540, 0.0606, TEA, ("milk tea", "brown", "a pink straw")
        ),
        2: partial(
            milk_tea, 0.029, 0.0425, 0.1540, 0.0606, MATCHA,
            ("matcha milk tea", "green", "a pink straw"),
        ),
        6: partial(
            milk_tea, 0.031, 0.0390, 0.1610, 0.0644, TARO,
            ("taro milk tea", "lilac", "a pink straw"),
        ),
    },
    "133_ramen-bowl": {
        0: partial(
            ramen, 0.034, 0.047, 0.105, (RED, WHITE, RED), ("cup noodles", "red", "a foil lid")
        ),
        1: partial(
            ramen, 0.045, 0.062, 0.075, (YELLOW, RED, WHITE),
            ("noodle bowl", "yellow", "a foil lid"),
        ),
        2: partial(
            ramen, 0.036, 0.046, 0.095, (BLUE, CREAM, BLUE), ("cup noodles", "blue", "a foil lid")
        ),
    },
    "134_snack-bag": {
        0: partial(
            snack_bag, 0.110, 0.160, 0.040, (YELLOW, RED, WHITE),
            ("bag of crisps", "yellow", "a red oval"),
        ),
        1: partial(
            snack_bag, 0.120, 0.150, 0.045, (BLACK, ORANGE, WHITE),
            ("bag of nuts", "black", "an orange oval"),
        ),
        2: partial(
            snack_bag, 0.090, 0.125, 0.032, (BLUE, YELLOW, BLUE),
            ("bag of sweets", "blue", "a yellow oval"),
        ),
    },
}  # fmt: skip
