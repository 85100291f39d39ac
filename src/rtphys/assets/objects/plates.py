"""003_plate and 019_coaster, as wide as real ones (the official bounding boxes are wider)."""

from functools import partial

from rtphys.assets.asset_model import AssetModel, Body, Part, functional
from rtphys.assets.geometry import cylinder, lathe
from rtphys.assets.material import Colour, matt, plastic
from rtphys.assets.objects import Models
from rtphys.assets.pictures import speckle
from rtphys.assets.vessel import Vessel, band
from rtphys.assets.words import phrases


def plate(size: Vessel, mass: float, glaze: Colour, rim: Colour, colour: str) -> AssetModel:
    """A dinner plate with a coloured rim; the functional point is near its middle."""
    radius, top = size.outer[-1]
    inside = radius - size.wall
    stripe = lathe(
        [
            (inside, top - 0.0005),
            (radius, top - 0.0005),
            (radius, top + 0.0004),
            (inside, top + 0.0004),
        ],
        size.sides,
    )
    looks = (
        Part(size.shell(), plastic(glaze, 0.75), "ceramic", 50),
        Part(stripe, plastic(rim, 0.7), "ceramic"),
    )
    return AssetModel(
        body=Body(looks, size.parts(), mass),
        material="ceramic",
        description=phrases("plate", colour, "a coloured rim", "dinner plate"),
        functional_points=(functional((0, 0.0031, 0), (0, -1, 0), (1, 0, 0)),),
        categories=("plate", "tableware"),
    )


def coaster(radius: float, height: float, mass: float) -> AssetModel:
    """A round cork coaster in a darker ring; the functional point is on its underside."""
    cork = matt((1, 1, 1)).with_picture(speckle((0.74, 0.53, 0.33), "coaster", 0.22), "y")
    disc = Vessel(((radius, 0), (radius, height)), 0.006, 0.7 * height)
    looks = (
        Part(cylinder(radius - 0.002, height, 24).at(y=height / 2), cork, "wood"),
        Part(band(disc.outer, 0.0, height), matt((0.40, 0.24, 0.13)), "wood"),
    )
    return AssetModel(
        body=Body(looks, (cylinder(radius, height, 24).at(y=height / 2),), mass),
        material="wood",
        description=phrases("coaster", "brown", "a dark edge", "cork mat"),
        functional_points=(functional((0, 0, 0.0032), (0, -1, 0), (1, 0, 0)),),
        categories=("coaster", "tableware"),
    )


OUTER = ((0.060, 0.0), (0.066, 0.004), (0.092, 0.016), (0.107, 0.0276))
WHITE, BLUE = (0.94, 0.94, 0.92), (0.12, 0.30, 0.66)

MODELS: Models = {
    "003_plate": {0: partial(plate, Vessel(OUTER, 0.010, 0.005), 0.42, WHITE, BLUE, "white")},
    "019_coaster": {0: partial(coaster, 0.054, 0.0084, 0.030)},
}
