"""029_olive-oil, 031_jam-jar, 065_soy-sauce, 066_vinegar, 109_hydrating-oil: household bottles.

They are clutter; the first four have no contact points.
"""

from functools import partial

from rtphys.assets.asset_model import AssetModel, from_sides
from rtphys.assets.bottle import Bottle, Look, bottle_body
from rtphys.assets.objects import Models
from rtphys.assets.words import Words, phrases


def bottle(size: Bottle, look: Look, words: Words, kind: str, grip: float = 0.0) -> AssetModel:
    """One bottle or jar; with side grasps at the height `grip` [m] if given."""
    return AssetModel(
        body=bottle_body(size, look),
        material=look.material,
        description=phrases(*words, kind),
        contact_points=from_sides(grip, (0, 90, 180, 270)) if grip else (),
        categories=(words[0], "kitchen" if not grip else "bathroom"),
    )


OLIVE, GREEN, YELLOW = (0.35, 0.38, 0.10), (0.10, 0.32, 0.14), (0.86, 0.70, 0.15)
CREAM, GOLD, BLACK = (0.95, 0.90, 0.76), (0.80, 0.62, 0.22), (0.10, 0.08, 0.08)
SOY, RED, WHITE = (0.16, 0.08, 0.05), (0.78, 0.12, 0.10), (0.94, 0.94, 0.92)
BROWN, BERRY, ORANGE = (0.40, 0.22, 0.10), (0.52, 0.06, 0.16), (0.93, 0.50, 0.10)
PLUM, HONEY, BLUE = (0.36, 0.10, 0.24), (0.80, 0.45, 0.10), (0.15, 0.35, 0.70)
PINK, MINT, PALE = (0.94, 0.68, 0.74), (0.62, 0.84, 0.76), (0.93, 0.88, 0.78)

# Height, radius, shoulder, collar, neck, label, mass.
MODELS: Models = {
    "029_olive-oil": {
        0: partial(
            bottle,
            Bottle(0.305, 0.036, 0.195, 0.235, 0.0140, (0.06, 0.15), 0.55, top="cork"),
            Look(GREEN, GREEN, GOLD, CREAM, OLIVE, GOLD, "fruit", "glass"),
            ("olive oil", "dark green", "a cream label"), "oil bottle",
        ),
        1: partial(
            bottle,
            Bottle(0.285, 0.032, 0.150, 0.255, 0.0140, (0.04, 0.11), 0.45),
            Look(OLIVE, OLIVE, BLACK, YELLOW, GREEN, GREEN, "badge", "glass"),
            ("olive oil", "olive green", "a yellow label"), "oil bottle",
        ),
        3: partial(
            bottle,
            Bottle(0.270, 0.039, 0.200, 0.230, 0.0160, (0.05, 0.17), 0.60, foot=0.97),
            Look(YELLOW, YELLOW, GREEN, WHITE, GREEN, YELLOW, "wave"),
            ("olive oil", "golden", "a green cap"), "oil bottle",
        ),
    },
    "031_jam-jar": {
        1: partial(
            bottle,
            Bottle(0.095, 0.036, 0.066, 0.074, 0.0310, (0.018, 0.060), 0.38, top="jar"),
            Look(BERRY, BERRY, RED, CREAM, BERRY, GREEN, "fruit", "glass"),
            ("jam jar", "dark red", "a red lid"), "jar",
        ),
        2: partial(
            bottle,
            Bottle(0.115, 0.034, 0.082, 0.090, 0.0300, (0.02, 0.07), 0.40, top="jar"),
            Look(ORANGE, ORANGE, WHITE, WHITE, ORANGE, BROWN, "badge", "glass"),
            ("marmalade jar", "orange", "a white lid"), "jar",
        ),
        4: partial(
            bottle,
            Bottle(0.085, 0.042, 0.052, 0.062, 0.0350, (0.012, 0.046), 0.42, top="jar"),
            Look(HONEY, HONEY, GOLD, YELLOW, BROWN, BROWN, "blocks", "glass"),
            ("honey jar", "amber", "a golden lid"), "jar",
        ),
    },
    "065_soy-sauce": {
        0: partial(
            bottle,
            Bottle(0.225, 0.031, 0.140, 0.185, 0.0130, (0.04, 0.12), 0.42),
            Look(SOY, SOY, RED, RED, YELLOW, WHITE, "band", "glass"),
            ("soy sauce", "black", "a red label"), "sauce bottle",
        ),
        1: partial(
            bottle,
            Bottle(0.205, 0.036, 0.125, 0.165, 0.0150, (0.03, 0.10), 0.40, top="flip"),
            Look(SOY, SOY, GREEN, GREEN, WHITE, GREEN, "badge"),
            ("soy sauce", "black", "a green cap"), "sauce bottle",
        ),
        4: partial(
            bottle,
            Bottle(0.150, 0.038, 0.050, 0.110, 0.0160, (0.012, 0.045), 0.26, top="flip"),
            Look(SOY, SOY, RED, CREAM, RED, BLACK, "blocks", "glass"),
            ("soy sauce", "dark brown", "a red cap"), "sauce bottle",
        ),
    },
    "066_vinegar": {
        0: partial(
            bottle,
            Bottle(0.240, 0.035, 0.160, 0.200, 0.0130, (0.05, 0.14), 0.45, filled=0.17),
            Look((0.82, 0.86, 0.82), (0.90, 0.82, 0.55), BLUE, WHITE, BLUE, BLUE, "wave", "glass"),
            ("vinegar", "pale yellow", "a blue cap"), "vinegar bottle",
        ),
        1: partial(
            bottle,
            Bottle(0.250, 0.033, 0.170, 0.190, 0.0120, (0.06, 0.15), 0.44, top="cork"),
            Look(PLUM, PLUM, BLACK, CREAM, PLUM, BLACK, "blocks", "glass"),
            ("vinegar", "dark purple", "a black cap"), "vinegar bottle",
        ),
    },
    "109_hydrating-oil": {
        0: partial(
            bottle,
            Bottle(0.154, 0.030, 0.105, 0.120, 0.0130, (0.03, 0.09), 0.15, top="pump"),
            Look(PALE, PALE, GOLD, WHITE, GOLD, BROWN, "badge"),
            ("body oil", "cream-coloured", "a golden pump"), "cosmetic bottle", 0.0525,
        ),
        1: partial(
            bottle,
            Bottle(0.154, 0.027, 0.110, 0.122, 0.0150, (0.03, 0.09), 0.12, top="flip"),
            Look(PINK, PINK, WHITE, WHITE, PINK, RED, "wave"),
            ("body lotion", "pink", "a white cap"), "cosmetic bottle", 0.0525,
        ),
        2: partial(
            bottle,
            Bottle(0.154, 0.031, 0.100, 0.116, 0.0140, (0.03, 0.08), 0.16, top="pump"),
            Look(MINT, MINT, WHITE, WHITE, MINT, BLUE, "band"),
            ("moisturiser", "mint green", "a white pump"), "cosmetic bottle", 0.0615,
        ),
    },
}  # fmt: skip
