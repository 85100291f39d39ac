"""049_shampoo: oval plastic bottles, broad along x."""

from functools import partial

from rtphys.assets.asset_model import AssetModel, Body, Part, contact
from rtphys.assets.bottle import Bottle, Look, bottle_body
from rtphys.assets.objects import Models
from rtphys.assets.words import Words, phrases


def shampoo(size: Bottle, share: float, look: Look, grip: float, words: Words) -> AssetModel:
    """A turned bottle, flattened along z to this share of its width."""
    turned = bottle_body(size, look)
    body = Body(
        tuple(
            Part(p.solid.scaled(1, 1, share), p.finish, p.material, p.crease_deg)
            for p in turned.visual
        ),
        tuple(s.scaled(1, 1, share) for s in turned.collision),
        size.mass,
    )
    return AssetModel(
        body=body,
        material="plastic",
        description=phrases(*words, "plastic bottle"),
        contact_points=tuple(contact((0, grip, 0), (s, 0, 0), (0, 1, 0)) for s in (-1, 1)),
        categories=("shampoo", "bathroom"),
    )


WHITE, BLUE, GREEN = (0.94, 0.94, 0.93), (0.14, 0.40, 0.75), (0.35, 0.62, 0.30)
PINK, PURPLE, BLACK = (0.92, 0.55, 0.66), (0.45, 0.25, 0.60), (0.13, 0.13, 0.15)
GOLD, TEAL, ORANGE = (0.80, 0.65, 0.30), (0.12, 0.56, 0.58), (0.95, 0.55, 0.18)

# Height, radius, shoulder, collar, neck, label, mass.
MODELS: Models = {
    "049_shampoo": {
        1: partial(
            shampoo,
            Bottle(0.193, 0.038, 0.150, 0.162, 0.0220, (0.04, 0.12), 0.24, top="flip"),
            0.62, Look(BLUE, BLUE, WHITE, WHITE, BLUE, BLUE, "wave"), 0.0947,
            ("shampoo", "blue", "a white cap"),
        ),
        2: partial(
            shampoo,
            Bottle(0.193, 0.034, 0.130, 0.150, 0.0150, (0.03, 0.11), 0.22, top="pump"),
            0.62, Look(GREEN, GREEN, WHITE, WHITE, GREEN, GOLD, "badge"), 0.0895,
            ("shampoo", "green", "a white pump"),
        ),
        3: partial(
            shampoo,
            Bottle(0.193, 0.0285, 0.155, 0.165, 0.0200, (0.05, 0.13), 0.20, top="flip"),
            0.85, Look(PINK, PINK, PURPLE, PINK, WHITE, PURPLE, "blocks"), 0.0895,
            ("conditioner", "pink", "a purple cap"),
        ),
        5: partial(
            shampoo,
            Bottle(0.193, 0.047, 0.120, 0.145, 0.0170, (0.025, 0.10), 0.30, top="pump"),
            0.61, Look(BLACK, BLACK, GOLD, BLACK, GOLD, GOLD, "band"), 0.0574,
            ("shower gel", "black", "a golden pump"),
        ),
        7: partial(
            shampoo,
            Bottle(0.194, 0.042, 0.135, 0.158, 0.0180, (0.03, 0.11), 0.27, top="flip"),
            0.70, Look(ORANGE, ORANGE, TEAL, WHITE, TEAL, ORANGE, "fruit"), 0.0548,
            ("shampoo", "orange", "a teal cap"),
        ),
    }
}  # fmt: skip
