"""035_apple and 130_fruit: fruit and vegetables. Each stands on a small flat, as ripe ones do, and
so does not roll away; official apples are meant to roll and are not flagged stable."""

from functools import partial
from itertools import pairwise

import numpy as np

from rtphys.assets.asset_model import AssetModel, Body, Part, from_above
from rtphys.assets.geometry import cylinder, lathe
from rtphys.assets.material import Colour, Finish, matt, plastic
from rtphys.assets.objects import Models
from rtphys.assets.pictures import speckle
from rtphys.assets.solid import hull, together
from rtphys.assets.turned import turned_parts
from rtphys.assets.words import Words, phrases

Profile = tuple[tuple[float, float], ...]

# Share of the radius and of the height, foot to stalk.
APPLE: Profile = ((0.34, 0.0), (0.78, 0.16), (1.0, 0.52), (0.88, 0.82), (0.52, 0.97), (0.20, 0.92))
ORANGE: Profile = ((0.30, 0.0), (0.72, 0.12), (0.97, 0.36), (0.97, 0.64), (0.72, 0.88), (0.28, 1.0))
PEAR: Profile = ((0.38, 0.0), (0.90, 0.16), (1.0, 0.34), (0.72, 0.62), (0.44, 0.84), (0.22, 0.98))
LEMON: Profile = ((0.25, 0.0), (0.62, 0.10), (1.0, 0.38), (0.98, 0.62), (0.62, 0.88), (0.22, 1.0))
TOMATO: Profile = ((0.45, 0.0), (0.88, 0.18), (1.0, 0.48), (0.90, 0.78), (0.55, 0.98), (0.20, 0.93))


def fruit(
    profile: Profile,
    size: tuple[float, float, float],
    skin: Colour,
    stalk: Colour,
    words: Words,
    grip: float = 0.0,
) -> AssetModel:
    """A turned fruit; size: radius, height [m], mass [kg]; `grip` [m] if it is to be grasped."""
    radius, height, mass = size
    points = [(radius * r, height * y) for r, y in profile]
    body = lathe([(0, 0), *points, (0, points[-1][1])], 16)
    stem = cylinder(0.0018, 0.009, 6).turned("z", 12).at(y=points[-1][1] + 0.002)
    return AssetModel(
        body=Body(
            (Part(body, _skin(skin, words[0]), "food", 60), Part(stem, matt(stalk), "food")),
            (*turned_parts([(0, 0), *((np.cos(np.pi / 16) * r, y) for r, y in points)]), stem),
            mass,
        ),
        material="food",
        description=phrases(*words, "fruit"),
        contact_points=from_above((0, grip, 0)) if grip else (),
        categories=(words[0], "food"),
    )


def banana(length: float, thick: float, mass: float, words: Words) -> AssetModel:
    """A curved banana lying on its side."""
    bend = np.deg2rad(np.linspace(-48, 48, 7))
    radius = length / (2 * np.sin(bend[-1]))
    girth = 0.5 * thick * np.array([0.30, 0.80, 1.0, 1.0, 0.97, 0.72, 0.22])
    around = 2 * np.pi * (np.arange(8) + 0.5) / 8
    rings = [
        np.stack(
            [
                (radius + g * np.cos(around)) * np.sin(t),
                np.maximum(g * (np.sin(around) + 0.7), 0.0),
                (radius + g * np.cos(around)) * np.cos(t) - radius * np.cos(0.5 * bend[-1]),
            ],
            axis=1,
        )
        for t, g in zip(bend, girth, strict=True)
    ]
    pieces = [hull(np.vstack([a, b])) for a, b in pairwise(rings)]
    flesh, tips = pieces[1:-1], [pieces[0], pieces[-1]]
    looks = (
        Part(together(*flesh), plastic((0.96, 0.82, 0.16), 0.4), "food", 50),
        Part(together(*tips), matt((0.42, 0.36, 0.12)), "food", 50),
    )
    return AssetModel(
        body=Body(looks, tuple(pieces), mass),
        material="food",
        description=phrases(*words, "fruit"),
        categories=("banana", "food"),
    )


def _skin(colour: Colour, name: str) -> Finish:
    return plastic((1, 1, 1), 0.5).with_picture(speckle(colour, name, 0.06, 16), "cylinder")


RED, GREEN, YELLOW = (0.78, 0.12, 0.10), (0.52, 0.72, 0.20), (0.95, 0.82, 0.20)
BROWN, LEAF = (0.32, 0.20, 0.10), (0.24, 0.46, 0.16)

MODELS: Models = {
    "035_apple": {
        0: partial(
            fruit, APPLE, (0.0295, 0.0570, 0.14), RED, BROWN, ("apple", "red", "a stalk"), 0.0281
        ),
        1: partial(
            fruit, APPLE, (0.0262, 0.0490, 0.10), GREEN, BROWN,
            ("small apple", "green", "a stalk"), 0.0311,
        ),
    },
    "130_fruit": {
        0: partial(
            fruit, ORANGE, (0.0365, 0.0700, 0.19), (0.95, 0.52, 0.08), LEAF,
            ("orange", "bright", "a dimpled skin"),
        ),
        1: partial(
            fruit, PEAR, (0.0330, 0.0920, 0.18), (0.72, 0.76, 0.26), BROWN,
            ("pear", "yellow-green", "a slim neck"),
        ),
        2: partial(
            fruit, TOMATO, (0.0345, 0.0560, 0.13), (0.84, 0.14, 0.08), LEAF,
            ("tomato", "red", "a green stalk"),
        ),
        3: partial(banana, 0.160, 0.034, 0.14, ("banana", "yellow", "dark tips")),
        4: partial(
            fruit, LEMON, (0.0270, 0.0680, 0.09), YELLOW, LEAF,
            ("lemon", "yellow", "a pointed top"),
        ),
    },
}  # fmt: skip
