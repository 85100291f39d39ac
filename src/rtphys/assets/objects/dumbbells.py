"""052_dumbbell: hexagonal weights, so that they lie still."""

from dataclasses import dataclass
from functools import partial

import numpy as np

from rtphys.assets.asset_model import AssetModel, Body, Part
from rtphys.assets.material import Colour, metal, plastic
from rtphys.assets.objects import Models
from rtphys.assets.solid import Solid
from rtphys.assets.swept import lying, rod


@dataclass(frozen=True)
class Dumbbell:
    """Sizes [m], direction it lies in ("x" or "z"), mass [kg]."""

    length: float
    radius: float  # of the heads, to a corner
    head: float  # length of one head
    bar: float  # radius
    along: str
    mass: float


def dumbbell(size: Dumbbell, colour: Colour, words: tuple[str, ...]) -> AssetModel:
    """Two six sided heads on a steel bar."""
    r, half = size.radius, size.length / 2
    height = r * np.cos(np.pi / 6)
    heads = [_head(size, s) for s in (-1, 1)]
    collars = [rod(0.55 * r, s * (half - size.head) - 0.003, s * (half - size.head) + 0.003, 12)
               .at(y=height - 0.55 * r * np.cos(np.pi / 12)) for s in (-1, 1)]  # fmt: skip
    low = height - size.bar * np.cos(np.pi / 12)
    bar = rod(size.bar, size.head - half, half - size.head, 12).at(y=low)
    angle = 90 if size.along == "x" else 0
    looks = (
        Part((heads[0] + heads[1]).turned("y", angle), plastic(colour, 0.4), "rubber"),
        Part((bar + collars[0] + collars[1]).turned("y", angle), metal(), "steel"),
    )
    parts = tuple(p.turned("y", angle) for p in (*heads, bar))
    return AssetModel(
        body=Body(looks, parts, size.mass),
        material="rubber",
        description=words,
        categories=("dumbbell", "sport"),
    )


def _head(size: Dumbbell, side: int) -> Solid:
    r, half = size.radius, size.length / 2
    inner = half - size.head
    profile = [(0, inner), (0.86 * r, inner), (r, inner + 0.006)]
    profile += [(r, half - 0.006), (0.86 * r, half), (0, half)]
    head = lying(profile, 6)
    return head if side > 0 else head.scaled(1, 1, -1)


MODELS: Models = {
    "052_dumbbell": {
        2: partial(
            dumbbell,
            Dumbbell(0.190, 0.0335, 0.055, 0.0130, "z", 2.0),
            (0.12, 0.12, 0.13),
            ("black dumbbell", "dumbbell", "hexagonal dumbbell", "black weight"),
        ),
        4: partial(
            dumbbell,
            Dumbbell(0.190, 0.0405, 0.060, 0.0140, "x", 3.0),
            (0.20, 0.42, 0.72),
            ("blue dumbbell", "big dumbbell", "blue weight", "heavy blue dumbbell"),
        ),
        6: partial(
            dumbbell,
            Dumbbell(0.188, 0.0330, 0.050, 0.0120, "x", 1.5),
            (0.88, 0.38, 0.55),
            ("pink dumbbell", "small dumbbell", "pink weight", "light pink dumbbell"),
        ),
    },
}
