"""040_rack: a mug tree. Its peg at +x is where mugs hang.

The peg's tip and its direction there are the official ones. Nearer the post it rises again, so that
a mug comes to rest in the bend, half way between post and tip, where the task looks for it: on a
straight peg it would slide on down to the post. The foot is on the ground; the official model
reaches 1.9 cm below its origin.
"""

from functools import partial
from itertools import pairwise

import numpy as np

from rtphys.assets.asset_model import AssetModel, Body, Part, functional
from rtphys.assets.geometry import ball, cone, cylinder, tube
from rtphys.assets.material import matt
from rtphys.assets.objects import Models
from rtphys.assets.pictures import grain
from rtphys.assets.solid import hull, together
from rtphys.assets.words import phrases

TIP = (0.0652, 0.1945, 0.0)  # [m]
INWARD = (-0.62, -0.78, 0.0)  # along the peg at its tip
PEG = 0.0055  # [m] radius
BEND = 0.049  # [m] from the tip along the peg


def rack(height: float, foot: float, mass: float) -> AssetModel:
    """A turned foot, a post with a knob, two pegs."""
    tip, along = np.array(TIP), np.array(INWARD)
    bend = tip + BEND * along
    path = np.array([tip, bend, (0.0, bend[1] + 0.020, 0.0)])
    pegs = [tube(path, PEG, 8), tube(path * (-1, 1, 1), PEG, 8)]
    legs = [hull(tube(leg, PEG, 8).vertices) for leg in pairwise(path)]
    legs += [leg.scaled(-1, 1, 1) for leg in legs]
    base = cone(foot, 0.9 * foot, 0.014, 24)
    post = cylinder(0.009, height - 0.03, 12).at(y=0.5 * (height - 0.03) + 0.010)
    knob = ball(0.014, 12).at(y=height - 0.014)
    wood = matt((1, 1, 1)).with_picture(grain((0.76, 0.55, 0.33), "rack", 0.2), "z")
    looks = (
        Part(together(base, post, knob), wood, "wood"),
        Part(together(*pegs), matt((0.45, 0.27, 0.14)), "wood"),
    )
    return AssetModel(
        body=Body(looks, (base, post, knob, *legs), mass),
        material="wood",
        description=phrases("mug rack", "wooden", "two hooks", "mug tree"),
        functional_points=(functional(TIP, INWARD, (-0.78, 0.62, 0)),),
        categories=("rack", "kitchen"),
    )


MODELS: Models = {"040_rack": {0: partial(rack, 0.245, 0.061, 0.65)}}
