"""132_spoon: spoons and a ladle, lying. Own category, for clutter."""

from dataclasses import dataclass
from functools import partial
from itertools import pairwise

from rtphys.assets.asset_model import AssetModel, Body, Part
from rtphys.assets.geometry import box
from rtphys.assets.material import Finish, matt, metal, plastic
from rtphys.assets.objects import Models
from rtphys.assets.solid import hull
from rtphys.assets.vessel import Vessel
from rtphys.assets.words import Words, phrases


@dataclass(frozen=True)
class Spoon:
    """Sizes [m]."""

    radius: float  # of the bowl, across
    long: float  # its length as a share of its width
    depth: float  # height of its rim
    length: float  # of the whole spoon
    handle: float  # width
    mass: float  # [kg]


def spoon(size: Spoon, finish: Finish, stuff: str, words: Words) -> AssetModel:
    """A bowl towards +z; the handle bows up and touches down at its end."""
    wall = 0.10 * size.radius + 0.001
    outline = ((0.45, 0.0), (0.82, 0.45), (1.0, 1.0))
    outer = tuple((size.radius * r, size.depth * y) for r, y in outline)
    bowl = Vessel(outer, wall, 0.25 * size.depth, 16, 8)
    centre = 0.5 * size.length - size.long * size.radius
    shell = bowl.shell().scaled(1, 1, size.long).at(z=centre)
    back = centre - 0.92 * size.long * size.radius
    end, high = -0.5 * size.length, size.depth + 0.006
    joints = ((0.45, 0.8 * size.depth, back), (0.55, high, 0.45 * (back + end)), (1.0, 0.002, end))
    slabs = [box(size.handle * w, 0.004, 0.008).at(0, y, z + 0.004) for w, y, z in joints]
    bars = tuple(hull([*a.vertices, *b.vertices]) for a, b in pairwise(slabs))
    looks = (Part(shell + bars[0] + bars[1], finish, stuff, 50),)
    solid = hull(shell.vertices)
    return AssetModel(
        body=Body(looks, (solid, *bars), size.mass),
        material=stuff,
        description=phrases(*words, "cutlery"),
        categories=("spoon", "tableware"),
    )


MODELS: Models = {
    "132_spoon": {
        0: partial(
            spoon, Spoon(0.021, 1.45, 0.009, 0.190, 0.018, 0.045), metal(roughness=0.2), "steel",
            ("spoon", "silver", "a long handle"),
        ),
        1: partial(
            spoon, Spoon(0.027, 1.30, 0.012, 0.250, 0.022, 0.050), matt((0.74, 0.52, 0.30)), "wood",
            ("cooking spoon", "wooden", "a wide bowl"),
        ),
        2: partial(
            spoon, Spoon(0.024, 1.20, 0.014, 0.140, 0.020, 0.040), plastic((0.92, 0.92, 0.90), 0.7),
            "ceramic", ("soup spoon", "white", "a deep bowl"),
        ),
    }
}  # fmt: skip
