"""114_bottle: emptied bottles that are thrown away; nearly empty, so they weigh little."""

from functools import partial

from rtphys.assets.asset_model import AssetModel, from_sides, functional
from rtphys.assets.bottle import Bottle, Look, bottle_body
from rtphys.assets.objects import Models
from rtphys.assets.words import Words, phrases

FROM_BEHIND = (180, 225, 270, 315, 0, 45, 90, 135)  # official orders of the side grasps
HIGHER = 0.035  # [m]
FROM_LEFT = (270, 0, 90, 180, 315, 45, 135, 225)


def bottle(
    size: Bottle, look: Look, grip: float, azimuths: tuple[int, ...], words: Words
) -> AssetModel:
    """One bottle; functional points are the foot, down, and the mouth, up.

    Beyond the official grasps there is a second ring, for a hand that must stay above the bin's
    rim where the table is low.
    """
    mouth = size.height - 0.006
    return AssetModel(
        body=bottle_body(size, look),
        material=look.material,
        description=phrases(*words, "bottle"),
        contact_points=from_sides(grip, azimuths) + from_sides(grip + HIGHER, azimuths),
        functional_points=(
            functional((0, 0, 0), (0, -1, 0), (1, 0, 0)),
            functional((0, mouth, 0), (0, 1, 0), (1, 0, 0)),
        ),
        categories=("bottle", "waste"),
    )


CLEAR, WATER, BLUE = (0.80, 0.88, 0.92), (0.62, 0.80, 0.90), (0.10, 0.30, 0.75)
WHITE, RED, GREEN = (0.95, 0.95, 0.93), (0.80, 0.10, 0.10), (0.10, 0.50, 0.24)
TEA, YELLOW, BROWN = (0.62, 0.33, 0.10), (0.97, 0.80, 0.12), (0.38, 0.20, 0.10)
MINT, PINK, BLACK = (0.55, 0.82, 0.70), (0.92, 0.35, 0.50), (0.10, 0.10, 0.11)

MODELS: Models = {
    "114_bottle": {
        1: partial(
            bottle,
            Bottle(0.2155, 0.0325, 0.150, 0.188, 0.0130, (0.095, 0.135), 0.06, filled=0.045),
            Look(CLEAR, WATER, RED, RED, WHITE, WHITE, "band"),
            0.0801,
            FROM_BEHIND,
            ("empty water bottle", "clear", "a red label"),
        ),
        2: partial(
            bottle,
            Bottle(0.2270, 0.0385, 0.155, 0.190, 0.0170, (0.090, 0.150), 0.08, top="wide"),
            Look(TEA, TEA, YELLOW, YELLOW, BROWN, BROWN, "badge"),
            0.0820,
            FROM_BEHIND,
            ("iced tea bottle", "brown", "a yellow cap"),
        ),
        3: partial(
            bottle,
            Bottle(0.2475, 0.0330, 0.165, 0.205, 0.0125, (0.095, 0.150), 0.07),
            Look(GREEN, GREEN, WHITE, WHITE, GREEN, RED, "wave"),
            0.1219,
            FROM_LEFT,
            ("empty soda bottle", "green", "a white cap"),
        ),
        4: partial(
            bottle,
            Bottle(0.2195, 0.0390, 0.160, 0.185, 0.0200, (0.080, 0.140), 0.09, top="sport"),
            Look(MINT, MINT, BLACK, PINK, WHITE, WHITE, "band"),
            0.1168,
            FROM_BEHIND,
            ("shaker bottle", "mint green", "a black nozzle"),
        ),
    }
}
