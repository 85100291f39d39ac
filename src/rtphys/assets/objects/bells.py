"""050_bell: desk bells, as wide as the official meshes (whose metadata boxes are a third wider)."""

from dataclasses import dataclass
from functools import partial

from rtphys.assets.asset_model import AssetModel, Body, Part, contact
from rtphys.assets.geometry import cone, cylinder, lathe, rounded
from rtphys.assets.material import Colour, Finish, metal, plastic
from rtphys.assets.objects import Models


@dataclass(frozen=True)
class Bell:
    """Sizes [m]: foot, dome and plunger, bottom to top."""

    foot_radius: float
    dome_radius: float
    dome_top: float
    height: float  # top of the plunger
    knob: float  # its radius
    press: float  # height of the contact point
    mass: float  # [kg]


def bell(size: Bell, dome: Finish, foot_colour: Colour, words: tuple[str, ...]) -> AssetModel:
    """A bell on a round foot; the plunger sticks out on top."""
    r, top = size.dome_radius, size.dome_top
    foot = cone(size.foot_radius, 0.84 * size.foot_radius, 0.010, 24)
    outline = [
        (0.0, 0.010),
        (r, 0.010),
        (r, 0.024),
        (0.93 * r, 0.62 * top),
        (0.55 * r, top),
        (0, top),
    ]
    bowl = lathe(rounded(outline, 0.35 * r, 3, closed=False), 24)
    rim = cylinder(1.03 * r, 0.003, 24).at(y=0.0125)
    stem = cylinder(0.0035, size.height - top, 10).at(y=(size.height + top) / 2)
    knob = cone(size.knob, 0.75 * size.knob, 0.005, 12).at(y=size.height - 0.005)
    looks = (
        Part(foot, plastic(foot_colour, 0.6), "plastic"),
        Part(bowl + rim, dome, "steel", 50),
        Part(stem + knob, metal((0.55, 0.55, 0.58)), "steel"),
    )
    body = lathe(outline, 16)
    plunger = cylinder(0.9 * size.knob, size.height - top + 0.004, 8).at(
        y=(size.height + top - 0.004) / 2
    )
    hulls = (cone(size.foot_radius, 0.84 * size.foot_radius, 0.010, 20), body, plunger)
    return AssetModel(
        body=Body(looks, hulls, size.mass),
        material="steel",
        description=words,
        contact_points=(contact((0, size.press, 0), (0, 1, 0), (1, 0, 0)),),
        categories=("bell", "office"),
    )


SILVER = metal((0.82, 0.83, 0.86), 0.25)
BRASS = metal((0.86, 0.68, 0.28), 0.3)

MODELS: Models = {
    "050_bell": {
        0: partial(
            bell,
            Bell(0.0482, 0.0381, 0.050, 0.0667, 0.0075, 0.03804, 0.14),
            SILVER,
            (0.10, 0.10, 0.12),
            (
                "silver desk bell",
                "service bell",
                "shiny round bell",
                "metal bell on a black foot",
            ),
        ),
        1: partial(
            bell,
            Bell(0.0385, 0.0350, 0.0445, 0.0525, 0.0105, 0.02579, 0.11),
            BRASS,
            (0.35, 0.17, 0.07),
            (
                "brass desk bell",
                "golden bell",
                "small reception bell",
                "bell on a brown foot",
            ),
        ),
    }
}
