"""020_hammer: the handle lies along y, the striking face looks along +z."""

from functools import partial

import numpy as np

from rtphys.assets.asset_model import AssetModel, Body, Part, contact, functional
from rtphys.assets.geometry import box, extrude, rounded_box
from rtphys.assets.material import Colour, metal, plastic
from rtphys.assets.objects import Models
from rtphys.assets.solid import Solid, hull, together

HEAD = 0.0632  # [m] y of the head's axis
FACE = 0.0550  # [m] z of the striking face; its functional point lies 3.7 mm inside, for a firm hit
CLAW = -0.0763  # [m] z of the claw's tips
BUTT = -0.0823  # [m] y of the handle's end
GRIP = 0.0100  # [m] y of the hand: near the centre of mass, or a heavy head turns in the fingers
MASS = 0.20  # [kg] a 7 oz tack hammer: 18 cm is short for a claw hammer
TOP = 0.0961  # [m] y of the handle's other end, above the head


def hammer(grip: Colour, words: tuple[str, ...]) -> AssetModel:
    """A claw hammer with a rubber grip."""
    neck = _bar("z", 0.011, 0.034, 8).at(0, HEAD, 0.012)
    # Square: the lying hammer stands on one edge of its face, and on a round one it would topple
    # at a nudge.
    face = rounded_box(0.029, 0.029, 0.026, 0.002, 1).at(0, HEAD, FACE - 0.013)
    eye = rounded_box(0.0312, 0.034, 0.032, 0.004, 1).at(0, HEAD, -0.012)
    claws = [_claw(side) for side in (-1, 1)]
    shaft = rounded_box(0.017, TOP - 0.02, 0.022, 0.005, 2).at(0, (TOP + 0.02) / 2, 0)
    handle = rounded_box(0.025, 0.104, 0.028, 0.008, 2).at(0, BUTT + 0.052, 0)
    # The flared end is what the lying hammer rests on: it sets the tilt at which it lies.
    butt = hull([
        *rounded_box(0.026, 0.016, 0.030, 0.006, 1).at(0, BUTT + 0.008, 0).vertices,
        *box(0.026, 0.006, 0.002).at(0, BUTT + 0.006, 0.023).vertices,
    ])  # fmt: skip
    looks = (
        Part(together(neck, face, eye, *claws), metal((0.62, 0.63, 0.66)), "steel"),
        Part(shaft, plastic((0.16, 0.16, 0.18), 0.3), "wood"),
        Part(together(handle, butt), plastic(grip, 0.25), "rubber"),
    )
    return AssetModel(
        body=Body(
            looks, (hull([*neck.vertices, *face.vertices]), eye, *claws, shaft, handle, butt), MASS
        ),
        material="rubber",
        description=words,
        contact_points=(contact((0, GRIP, 0), (0, 0, -1), (0, 1, 0)),),
        functional_points=(functional((0, HEAD, 0.0513), (0, 0, 1), (1, 0, 0)),),
        categories=("hammer", "tool"),
        stable=False,
    )


def _bar(axis: str, radius: float, length: float, sides: int) -> Solid:
    angles = 2 * np.pi * (np.arange(sides) + 0.5) / sides
    outline = radius * np.stack([np.cos(angles), np.sin(angles)], axis=1)
    bar = extrude(outline, length).at(y=-length / 2)
    return bar.turned("x", 90) if axis == "z" else bar


def _claw(side: int) -> Solid:
    """One of two prongs, bent towards the handle; flat enough to be convex."""
    root = box(0.0125, 0.022, 0.004).at(side * 0.0088, HEAD + 0.003, -0.027)
    tip = box(0.008, 0.003, 0.004).at(side * 0.0115, HEAD - 0.012, CLAW + 0.002)
    return hull([*root.vertices, *tip.vertices])


MODELS: Models = {
    "020_hammer": {
        0: partial(
            hammer,
            (0.80, 0.16, 0.10),
            ("hammer", "claw hammer", "hammer with a red grip", "steel hammer with a red handle"),
        ),
    }
}
