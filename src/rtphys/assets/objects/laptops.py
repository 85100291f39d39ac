"""015_laptop: a base and a thin lid on one hinge.

Links as in the official models: y up, +z to the user, x to the user's right; a fixed joint stands
them up in the z-up root. The hinge is at the rear edge, q = 0 is shut, larger is more open.
"""

from dataclasses import dataclass
from functools import partial

import numpy as np

from rtphys.assets.asset_model import ArticulatedModel, Body, Joint, Part, contact
from rtphys.assets.geometry import box, rounded_box
from rtphys.assets.material import Colour, Finish, Picture, metal, plastic, tint
from rtphys.assets.objects import Models
from rtphys.assets.pictures import keys, screen
from rtphys.assets.solid import together
from rtphys.assets.urdf import placed, root_joint

GAP = 0.001  # [m] between shut lid and base
STEP = 0.20  # [rad] the second contact point is the first one, turned this far open


@dataclass(frozen=True)
class Laptop:
    """Sizes [m] and the hinge's range [rad]."""

    width: float
    depth: float
    base: float  # thickness
    lid: float  # thickness
    opening: float  # [rad] upper limit
    grip: float  # x of the contact points on the lid's edge
    mass: float  # [kg]


def laptop(
    size: Laptop, shell: Colour, glow: Colour, metallic: bool, word: str
) -> ArticulatedModel:
    """A laptop; `word` describes its appearance."""
    cover = metal(shell, 0.4) if metallic else plastic(shell, 0.4)
    hinge = (0.0, size.base + GAP, -size.depth / 2 + 0.008)
    return ArticulatedModel(
        links={
            "base": Body((), ()),
            "link_0": _base(size, shell, cover),
            "link_1": _lid(size, glow, cover),
        },
        joints=(
            root_joint("base", "link_0"),
            Joint(
                "lid",
                "revolute",
                "link_0",
                "link_1",
                placed(hinge),
                (-1.0, 0.0, 0.0),
                (0.0, size.opening),
                damping=1.0,
            ),
        ),
        material="aluminium" if metallic else "plastic",
        description=(f"{word} laptop", "laptop", f"{word} notebook computer", "open laptop"),
        # A real hinge holds its lid at any angle. Friction would do, but then the joint's damping
        # could not be told apart from it; so the hinge is balanced instead.
        balanced=("link_1",),
        contact_points=tuple(("link_1", m) for m in _edge_points(size)),
        categories=("laptop", "electronics"),
    )


def _base(size: Laptop, shell: Colour, cover: Finish) -> Body:
    w, d, t = size.width, size.depth, size.base
    slab = rounded_box(w, t, d, min(0.005, 0.45 * t), 2).at(y=t / 2)
    board = plastic((1.0, 1.0, 1.0), 0.2).with_picture(
        keys(frame=(0.30, 0.30, 0.32), key=(0.07, 0.07, 0.08)), "y"
    )
    keyboard = box(0.86 * w, 0.0012, 0.42 * d).at(0, t, -0.10 * d)
    pad = box(0.30 * w, 0.0008, 0.24 * d).at(0, t, 0.31 * d)
    looks = (
        Part(slab, cover, "aluminium"),
        Part(keyboard, board),
        Part(pad, plastic(tint(shell, 0.75), 0.5)),
    )
    return Body(looks, (box(w, t, d).at(y=t / 2),), 0.7 * size.mass)


def _lid(size: Laptop, glow: Colour, cover: Finish) -> Body:
    w, t, length = size.width, size.lid, size.depth - 0.008
    middle = length / 2
    slab = rounded_box(w, t, length - 0.006, 0.45 * t, 1).at(0, t / 2, middle + 0.003)
    barrel = box(0.5 * w, t, 0.008).at(0, t / 2, 0.0)
    # Under the shut lid, so that it faces the user once open; bottom edge at the hinge.
    glass = box(0.93 * w, 0.0012, 0.86 * length).at(0, 0.0, middle + 0.004)
    lit = plastic((1.0, 1.0, 1.0), 0.6).with_picture(_display(screen(tint(glow, 0.45), glow)), "y")
    looks = (
        Part(together(slab, barrel), cover, "aluminium"),
        Part(glass, lit, "glass"),
    )
    return Body(looks, (box(w, t, length).at(0, t / 2, middle),), 0.3 * size.mass)


def _display(picture: Picture) -> Picture:
    """Picture of the display in a black bezel, turned over: its lower edge is at the hinge."""
    framed = np.zeros((picture.shape[0] + 4, picture.shape[1] + 4, 3), np.uint8)
    framed[2:-2, 2:-2] = picture
    return framed[::-1, ::-1]


def _edge_points(size: Laptop) -> list[np.ndarray]:
    """Contact points: 0 at the lid's free edge, 1 a little further open; 2, 3 with camera below."""
    reach = size.depth - 0.008 - 0.004
    out = []
    for side in (1.0, -1.0):
        edge = contact((size.grip, size.lid / 2, reach), (0, 0, 1), (side, 0, 0))
        out += [edge, placed((0, 0, 0), (-STEP, 0, 0)) @ edge]
    return out


SILVER, BLACK, WHITE = (0.72, 0.73, 0.75), (0.17, 0.17, 0.19), (0.90, 0.90, 0.88)
ROSE, GREY, BLUE = (0.85, 0.66, 0.62), (0.36, 0.38, 0.42), (0.16, 0.30, 0.55)
GOLD, RED, GREEN = (0.80, 0.72, 0.52), (0.60, 0.12, 0.14), (0.30, 0.44, 0.38)
CYAN, TEAL = (0.35, 0.60, 0.95), (0.20, 0.75, 0.70)
SUNSET, VIOLET = (0.85, 0.55, 0.30), (0.75, 0.45, 0.75)

# Size: width, depth, base, lid [m], opening [rad], grip [m], mass [kg]; shell, screen, metal?, word
ROWS: tuple[tuple[Laptop, Colour, Colour, bool, str], ...] = (
    (Laptop(0.212, 0.142, 0.015, 0.0070, 2.25, -0.045, 0.95), SILVER, CYAN, True, "silver"),
    (Laptop(0.190, 0.150, 0.014, 0.0065, 2.40, -0.045, 0.90), BLACK, TEAL, False, "black"),
    (Laptop(0.200, 0.146, 0.018, 0.0075, 2.20, -0.003, 1.05), WHITE, SUNSET, False, "white"),
    (Laptop(0.208, 0.140, 0.013, 0.0060, 2.60, -0.045, 0.85), ROSE, VIOLET, True, "rose"),
    (Laptop(0.220, 0.146, 0.016, 0.0070, 2.30, -0.045, 1.05), GREY, CYAN, True, "grey"),
    (Laptop(0.188, 0.142, 0.012, 0.0060, 2.80, -0.045, 0.80), BLUE, SUNSET, False, "blue"),
    (Laptop(0.180, 0.132, 0.020, 0.0080, 1.95, -0.015, 1.00), BLACK, TEAL, False, "chunky black"),
    (Laptop(0.205, 0.130, 0.014, 0.0065, 1.85, -0.045, 0.90), GOLD, CYAN, True, "golden"),
    (Laptop(0.200, 0.135, 0.015, 0.0070, 2.10, -0.045, 0.95), RED, SUNSET, False, "red"),
    (Laptop(0.195, 0.138, 0.013, 0.0060, 2.50, -0.045, 0.85), GREEN, TEAL, False, "green"),
    (Laptop(0.166, 0.125, 0.016, 0.0070, 3.10, -0.015, 0.75), SILVER, VIOLET, True, "small silver"),
)

MODELS: Models = {"015_laptop": {i: partial(laptop, *row) for i, row in enumerate(ROWS)}}
