"""080_pillbottle: plastic jars of tablets, 6 to 8 cm wide (the gripper closes around them)."""

from functools import partial

from rtphys.assets.asset_model import AssetModel, from_above, from_sides, functional
from rtphys.assets.bottle import Bottle, Look, bottle_body
from rtphys.assets.objects import Models
from rtphys.assets.words import Words, phrases


def pill_bottle(size: Bottle, look: Look, top: float, words: Words) -> AssetModel:
    """One jar; `top` is the height [m] of the grasps from above."""
    sides = from_sides(0.0725, (270, 315, 0, 45, 90, 135, 180, 225))
    return AssetModel(
        body=bottle_body(size, look),
        material=look.material,
        description=phrases(*words, "medicine bottle"),
        contact_points=sides + from_above((0, top, 0), range(0, 360, 45)),
        functional_points=(functional((0, 0, 0), (0, -1, 0), (1, 0, 0)),),
        categories=("pill bottle", "medicine"),
    )


WHITE, ORANGE, AMBER = (0.95, 0.95, 0.94), (0.92, 0.45, 0.08), (0.78, 0.38, 0.06)
BLUE, GREEN, RED = (0.12, 0.34, 0.74), (0.16, 0.55, 0.32), (0.78, 0.12, 0.12)
BROWN, YELLOW, PURPLE = (0.34, 0.17, 0.07), (0.97, 0.82, 0.20), (0.45, 0.22, 0.58)

# Height, radius, shoulder, collar, neck, label, mass.
MODELS: Models = {
    "080_pillbottle": {
        1: partial(
            pill_bottle,
            Bottle(0.1545, 0.031, 0.116, 0.122, 0.0270, (0.025, 0.095), 0.09, top="jar"),
            Look(ORANGE, ORANGE, WHITE, WHITE, ORANGE, BLUE, "blocks"),
            0.1248,
            ("pill bottle", "orange", "a white cap"),
        ),
        2: partial(
            pill_bottle,
            Bottle(0.1545, 0.039, 0.110, 0.120, 0.0300, (0.020, 0.100), 0.15, top="jar"),
            Look(WHITE, WHITE, GREEN, WHITE, GREEN, GREEN, "badge"),
            0.1247,
            ("vitamin bottle", "white", "a green cap"),
        ),
        3: partial(
            pill_bottle,
            Bottle(0.1545, 0.034, 0.105, 0.122, 0.0230, (0.020, 0.090), 0.12, top="jar"),
            Look(BROWN, BROWN, WHITE, YELLOW, BROWN, RED, "blocks", "glass"),
            0.1257,
            ("tablet bottle", "brown", "a yellow label"),
        ),
        4: partial(
            pill_bottle,
            Bottle(0.1555, 0.037, 0.118, 0.124, 0.0330, (0.015, 0.105), 0.13, top="jar"),
            Look(WHITE, WHITE, BLUE, BLUE, WHITE, BLUE, "wave"),
            0.1248,
            ("supplement bottle", "blue and white", "a blue cap"),
        ),
        5: partial(
            pill_bottle,
            Bottle(0.1545, 0.0335, 0.112, 0.120, 0.0280, (0.030, 0.085), 0.10, top="jar"),
            Look(AMBER, AMBER, RED, WHITE, PURPLE, RED, "band"),
            0.1257,
            ("capsule bottle", "amber", "a red cap"),
        ),
    }
}
