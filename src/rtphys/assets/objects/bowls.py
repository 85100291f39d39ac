"""002_bowl: rice, soup and salad bowls, of melamine unless noted.

The contact points sit 1 cm above the rim, so that the fingertips reach 2.5 cm down: the official
ones, at the rim, would drive the inner finger into the curved floor. A hand holds a bowl level
against its weight by the depth of the pinch alone: steep walls and light bowls. Model 3 is for
stacking: its shoulder centres it on the next one's rim, 2.7 cm up, so that rims stay free.
"""

from dataclasses import dataclass
from functools import partial

from rtphys.assets.asset_model import AssetModel, Body, Part, functional
from rtphys.assets.material import Colour, plastic
from rtphys.assets.objects import Models
from rtphys.assets.vessel import Vessel, band, pinch
from rtphys.assets.words import Words, phrases

ABOVE = 0.010  # [m] contact points above the rim


@dataclass(frozen=True)
class Look:
    """Outside, inside and stripe colours, the stripe's heights [m] and the material."""

    outside: Colour
    inside: Colour
    stripe: Colour
    heights: tuple[float, float]
    material: str = "plastic"


def bowl(size: Vessel, mass: float, look: Look, words: Words) -> AssetModel:
    """A bowl on a foot."""
    radius, top = size.rim
    stripe = band(size.outer, *look.heights, size.sides)
    looks = [
        Part(size.shell(), plastic(look.outside, 0.7), look.material, 50),
        Part(stripe, plastic(look.stripe, 0.6), look.material, 50),
    ]
    if look.inside != look.outside:
        looks.append(Part(size.liner(), plastic(look.inside, 0.7), look.material, 50))
    return AssetModel(
        body=Body(tuple(looks), size.parts(), mass),
        material=look.material,
        description=phrases(*words, "dish"),
        contact_points=pinch(radius, top + ABOVE),
        functional_points=(functional((0, 0, 0), (0, -1, 0), (1, 0, 0)),),
        categories=("bowl", "tableware"),
    )


WHITE, CREAM, BLUE = (0.94, 0.94, 0.92), (0.95, 0.90, 0.78), (0.12, 0.28, 0.62)
RED, GREEN, BLACK = (0.75, 0.14, 0.10), (0.35, 0.58, 0.40), (0.14, 0.13, 0.13)
TEAL, OCHRE, BROWN = (0.16, 0.52, 0.56), (0.85, 0.60, 0.20), (0.42, 0.25, 0.14)
PINK, GREY, WOOD = (0.93, 0.66, 0.66), (0.55, 0.57, 0.60), (0.66, 0.44, 0.24)

MODELS: Models = {
    "002_bowl": {
        1: partial(
            bowl,
            Vessel(((0.030, 0), (0.031, 0.006), (0.0540, 0.024), (0.0572, 0.0490)), 0.004, 0.007),
            0.12,
            Look(WHITE, WHITE, BLUE, (0.036, 0.044)),
            ("rice bowl", "white", "a blue stripe"),
        ),
        2: partial(
            bowl,
            Vessel(((0.034, 0), (0.046, 0.010), (0.0593, 0.026), (0.0617, 0.0505)), 0.004, 0.006),
            0.14,
            Look(RED, CREAM, BLACK, (0.043, 0.0495)),
            ("soup bowl", "red", "a cream inside"),
        ),
        3: partial(
            bowl,
            Vessel(
                ((0.034, 0), (0.033, 0.020), (0.054, 0.026), (0.0650, 0.031), (0.0660, 0.0560)),
                0.005,
                0.026,
            ),
            0.11,
            Look(TEAL, CREAM, WHITE, (0.042, 0.048)),
            ("footed bowl", "teal", "a white stripe"),
        ),
        4: partial(
            bowl,
            Vessel(((0.040, 0), (0.055, 0.014), (0.0635, 0.038), (0.0672, 0.0720)), 0.004, 0.006),
            0.18,
            Look(GREEN, WHITE, GREEN, (0.010, 0.012)),
            ("deep bowl", "green", "a white inside"),
        ),
        5: partial(
            bowl,
            Vessel(((0.036, 0), (0.050, 0.012), (0.0635, 0.036), (0.0662, 0.0690)), 0.004, 0.007),
            0.16,
            Look(OCHRE, BROWN, BROWN, (0.058, 0.068)),
            ("noodle bowl", "ochre", "a brown rim"),
        ),
        6: partial(
            bowl,
            Vessel(((0.036, 0), (0.050, 0.009), (0.0615, 0.025), (0.0640, 0.0493)), 0.0045, 0.006),
            0.12,
            Look(WOOD, WOOD, BROWN, (0.042, 0.047), "wood"),
            ("salad bowl", "wooden", "a dark stripe"),
        ),
        7: partial(
            bowl,
            Vessel(((0.034, 0), (0.040, 0.010), (0.0605, 0.029), (0.0635, 0.0506)), 0.004, 0.006),
            0.08,
            Look(PINK, PINK, GREY, (0.040, 0.050)),
            ("cereal bowl", "pink", "a grey rim"),
        ),
    }
}
