"""162_cactus: small cacti in clay pots."""

from dataclasses import dataclass
from functools import partial

from rtphys.assets.asset_model import AssetModel, Body, Part
from rtphys.assets.geometry import ball, capsule, cone, cylinder
from rtphys.assets.material import Colour, matt, plastic
from rtphys.assets.objects import Models
from rtphys.assets.pictures import stripes
from rtphys.assets.solid import Solid, together

SIDES = 16


@dataclass(frozen=True)
class Cactus:
    """Sizes [m], mass [kg]."""

    pot: float  # radius of the pot's rim
    rim: float  # its height
    radius: float  # of the plant
    height: float  # of the plant above the soil
    arms: bool
    mass: float


def cactus(size: Cactus, clay: Colour, bloom: Colour, words: tuple[str, ...]) -> AssetModel:
    """A pot filled with soil, a ribbed plant with a flower."""
    p, y, r = size.pot, size.rim, size.radius
    pot = cone(0.74 * p, 0.94 * p, 0.80 * y, SIDES)
    rim = cylinder(p, 0.22 * y, SIDES).at(y=0.89 * y)
    soil = cylinder(0.88 * p, 0.004, SIDES).at(y=y)
    body = _body(r, size.height).at(y=y)
    plants = [body]
    if size.arms:
        for s, at in ((-1, 0.45), (1, 0.60)):
            elbow = capsule(0.40 * r, 1.5 * r, 8).turned("z", 90)
            arm = capsule(0.40 * r, 0.40 * size.height, 8)
            plants.append(elbow.at(s * 1.15 * r, y + at * size.height, 0))
            plants.append(arm.at(s * 1.6 * r, y + (at + 0.14) * size.height, 0))
    flower = ball(0.34 * r, 8).scaled(1, 0.6, 1).at(y=y + size.height + 0.05 * r)
    ribs = plastic((1, 1, 1), 0.2).with_picture(
        stripes(((0.22, 0.50, 0.26), (0.36, 0.64, 0.36)), 8), "cylinder"
    )
    looks = (
        Part(pot + rim, matt(clay), "ceramic"),
        Part(soil, matt((0.26, 0.18, 0.12)), "food"),
        Part(together(*plants), ribs, "food", 50),
        Part(flower, plastic(bloom, 0.4), "food"),
    )
    return AssetModel(
        body=Body(looks, (pot, rim, *plants, flower), size.mass),
        material="ceramic",
        description=words,
        categories=("cactus", "plant"),
    )


def _body(radius: float, height: float) -> Solid:
    if height < 2.2 * radius:
        return (
            ball(radius, 16)
            .scaled(1, 0.5 * (height + 0.4 * radius) / radius, 1)
            .at(y=0.5 * (height - 0.4 * radius))
        )
    return capsule(radius, height + radius, 12).at(y=0.5 * (height - radius))


CLAY, WHITE, BLUE = (0.74, 0.40, 0.26), (0.90, 0.89, 0.86), (0.25, 0.42, 0.62)

MODELS: Models = {
    "162_cactus": {
        0: partial(
            cactus,
            Cactus(0.036, 0.058, 0.022, 0.085, True, 0.26),
            CLAY,
            (0.95, 0.45, 0.60),
            ("cactus", "cactus in a clay pot", "cactus with arms", "potted cactus"),
        ),
        1: partial(
            cactus,
            Cactus(0.040, 0.050, 0.032, 0.048, False, 0.28),
            WHITE,
            (0.98, 0.80, 0.20),
            ("round cactus", "small cactus", "cactus in a white pot", "ball cactus"),
        ),
        2: partial(
            cactus,
            Cactus(0.033, 0.046, 0.017, 0.100, False, 0.22),
            BLUE,
            (0.90, 0.25, 0.25),
            ("tall cactus", "cactus in a blue pot", "thin cactus", "cactus with a red flower"),
        ),
    },
}
