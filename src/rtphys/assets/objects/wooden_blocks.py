"""086_woodenblock: large building blocks, in tasks only a landmark for other objects.

They have no grasps, as in the official pack; the functional point is in the middle of the top.
"""

from collections.abc import Callable
from functools import partial
from itertools import pairwise

import numpy as np

from rtphys.assets.asset_model import AssetModel, Body, Part, functional
from rtphys.assets.geometry import box, circle, extrude, rounded_box
from rtphys.assets.material import Colour, matt
from rtphys.assets.objects import Models
from rtphys.assets.pictures import grain
from rtphys.assets.solid import Solid, hull
from rtphys.assets.swept import side_profile

SIDES = 20
Shape = Callable[[], tuple[Solid, tuple[Solid, ...], float]]  # visual, convex parts, top


def block(shape: Shape, colour: Colour, mass: float, words: tuple[str, ...]) -> AssetModel:
    """One painted or plain block of wood."""
    seen, parts, top = shape()
    wood = matt(colour).with_picture(grain((1.0, 1.0, 1.0), words[0], 0.18), "z")
    return AssetModel(
        body=Body((Part(seen, wood, "wood"),), parts, mass),
        material="wood",
        description=words,
        functional_points=(functional((0, top, 0), (0, 0, 1), (1, 0, 0)),),
        categories=("wooden block", "toy"),
    )


def _cuboid(x: float, y: float, z: float) -> tuple[Solid, tuple[Solid, ...], float]:
    part = rounded_box(x, y, z, 0.003, 1).at(y=y / 2)
    return part, (part,), y


def _pillar(radius: float, height: float) -> tuple[Solid, tuple[Solid, ...], float]:
    part = extrude(circle(radius, SIDES), height)
    return part, (part,), height


def _bridge(x: float, y: float, z: float) -> tuple[Solid, tuple[Solid, ...], float]:
    """A block with a round opening below; its parts are two legs and wedges of the arch."""
    radius = 0.30 * x
    angles = np.linspace(0, np.pi, 9)
    arc = radius * np.stack([np.cos(angles), np.sin(angles)], axis=1)
    outline = np.vstack([[(-x / 2, 0), (-x / 2, y), (x / 2, y), (x / 2, 0)], arc])
    turn = ("y", 90)
    seen = side_profile(outline, z).turned(*turn)
    parts = []
    for (a, b), (c, d) in pairwise(arc):
        outer = [_to_edge(p, x, y) for p in ((a, b), (c, d))]
        corners = [(a, b), (c, d), *outer]
        if abs(outer[0][1] - outer[1][1]) > 1e-9 and abs(outer[0][0] - outer[1][0]) > 1e-9:
            corners.append((np.copysign(x / 2, a + c), y))
        parts.append(hull([(s * z / 2, v, u) for u, v in corners for s in (-1, 1)]).turned(*turn))
    return seen, tuple(parts), y


def _to_edge(p: tuple[float, float], x: float, y: float) -> tuple[float, float]:
    """Where the ray from the origin through p leaves the block."""
    u, v = p
    reach = min(x / 2 / max(abs(u), 1e-9), y / max(v, 1e-9))
    return (u * reach, v * reach)


def _house(x: float, y: float, z: float) -> tuple[Solid, tuple[Solid, ...], float]:
    """A cube with a steep truncated roof."""
    wall = 0.55 * y
    low = box(x, wall, z).at(y=wall / 2)
    roof = hull([
        *box(x, 0.001, z).at(y=wall).vertices,
        *box(0.45 * x, 0.001, 0.45 * z).at(y=y - 0.0005).vertices,
    ])  # fmt: skip
    return hull([*low.vertices, *roof.vertices]), (hull([*low.vertices, *roof.vertices]),), y


MODELS: Models = {
    "086_woodenblock": {
        0: partial(
            block,
            partial(_cuboid, 0.101, 0.0986, 0.101),
            (0.80, 0.60, 0.38),
            0.55,
            ("wooden cube", "big wooden block", "plain wooden block", "cube of wood"),
        ),
        1: partial(
            block,
            partial(_pillar, 0.0355, 0.1018),
            (0.25, 0.45, 0.75),
            0.24,
            ("blue wooden cylinder", "blue wooden pillar", "round wooden block", "blue block"),
        ),
        2: partial(
            block,
            partial(_bridge, 0.130, 0.1018, 0.051),
            (0.80, 0.25, 0.20),
            0.31,
            ("red wooden arch", "wooden bridge block", "red toy arch", "red wooden block"),
        ),
        3: partial(
            block,
            partial(_cuboid, 0.150, 0.0510, 0.0375),
            (0.90, 0.72, 0.30),
            0.19,
            ("yellow wooden brick", "long wooden block", "yellow plank", "yellow wooden block"),
        ),
        4: partial(
            block,
            partial(_house, 0.121, 0.1528, 0.121),
            (0.35, 0.58, 0.32),
            0.95,
            ("green wooden block", "wooden tower block", "pointed wooden block", "green toy house"),
        ),
    }
}
