"""021_cup: tumblers, beakers and cups.

The official models 6 and 7 have grasps that no task can use (one on a handle, one in the middle of
the hollow); here every cup has the four rim grasps of models 0 to 5. Handles point along +x, where
no grasp is.
"""

from dataclasses import dataclass
from functools import partial

import numpy as np

from rtphys.assets.asset_model import AssetModel, Body, Part, functional
from rtphys.assets.bottle import with_handle
from rtphys.assets.labels import label
from rtphys.assets.material import Colour, plastic
from rtphys.assets.objects import Models
from rtphys.assets.pictures import Picture, bands, stripes
from rtphys.assets.vessel import Vessel, pinch
from rtphys.assets.words import Words, phrases


@dataclass(frozen=True)
class Cup:
    """Sizes [m]."""

    foot: float  # radius
    rim: float  # radius
    height: float
    grip: float  # height of the contact points
    mass: float  # [kg]
    reach: float = 0.0  # x of the handle's outside, 0 for none
    belly: float = 0.0  # radius at a third of the height, 0 for a straight wall
    wall: float = 0.0035

    def vessel(self) -> Vessel:
        """Its turned part."""
        outer = [(self.foot, 0.0), (self.rim, self.height)]
        if self.belly:
            outer.insert(1, (self.belly, 0.35 * self.height))
        return Vessel(tuple(outer), self.wall, 0.005)


@dataclass(frozen=True)
class Look:
    """Colours of outside, print and inside, and the material."""

    outside: Colour
    inside: Colour
    material: str
    picture: Picture | None = None


def cup(size: Cup, look: Look, words: Words) -> AssetModel:
    """A cup, with or without a handle."""
    vessel = size.vessel()
    finish = plastic((1, 1, 1) if look.picture is not None else look.outside, 0.6)
    if look.picture is not None:
        finish = finish.with_picture(look.picture, "cylinder")
    looks = (
        Part(vessel.shell(), finish, look.material, 50),
        Part(vessel.liner(), plastic(look.inside, 0.6), look.material, 50),
    )
    body = Body(looks, vessel.parts(), size.mass)
    if size.reach:
        body = with_handle(body, _handle(size, vessel), plastic(look.outside, 0.6))
    return AssetModel(
        body=body,
        material=look.material,
        description=phrases(*words, "drinking cup"),
        contact_points=pinch(vessel.rim[0], size.grip),
        functional_points=(functional((0, 0, 0), (0, -1, 0), (1, 0, 0)),),
        categories=("cup", "tableware"),
    )


def _handle(size: Cup, vessel: Vessel) -> list[tuple[float, float, float]]:
    """A D-shaped handle at +x; its ends lie in the wall."""
    low, high, out = 0.25 * size.height, 0.80 * size.height, size.reach - 0.006
    root = np.array([vessel.radius(low), vessel.radius(high)]) - 0.5 * size.wall
    return [
        (float(root[0]), low, 0),
        (out, low + 0.1 * size.height, 0),
        (out, high - 0.05 * size.height, 0),
        (float(root[1]), high, 0),
    ]


WHITE, CREAM, RED, BLUE = (
    (0.94, 0.94, 0.92),
    (0.93, 0.88, 0.76),
    (0.80, 0.14, 0.12),
    (0.1, 0.3, 0.7),
)
GREEN, YELLOW, BLACK = (0.20, 0.55, 0.32), (0.96, 0.78, 0.16), (0.10, 0.10, 0.11)
KRAFT, ORANGE, SKY = (0.72, 0.53, 0.34), (0.94, 0.48, 0.12), (0.55, 0.77, 0.90)
PINK, STEEL, DARK = (0.95, 0.62, 0.70), (0.72, 0.74, 0.77), (0.22, 0.14, 0.10)

ROWS: tuple[tuple[Cup, Look, Words], ...] = (
    (
        Cup(0.0330, 0.0420, 0.0895, 0.0836, 0.09),
        Look(WHITE, WHITE, "plastic", bands((WHITE, RED, WHITE, RED, WHITE), (3, 2, 2, 6, 4))),
        ("cup", "white", "red stripes"),
    ),
    (
        Cup(0.0280, 0.0360, 0.0915, 0.0900, 0.05),
        Look(BLUE, SKY, "plastic", stripes((BLUE, SKY), 8)),
        ("striped tumbler", "blue", "upright stripes"),
    ),
    (
        Cup(0.0270, 0.0385, 0.1120, 0.1100, 0.04),
        Look(KRAFT, CREAM, "paper", label(KRAFT, DARK, CREAM, "badge")),
        ("coffee cup", "brown", "a dark oval"),
    ),
    (
        Cup(0.0330, 0.0350, 0.0815, 0.0803, 0.13),
        Look(GREEN, CREAM, "ceramic", bands((GREEN, CREAM, GREEN), (1, 1, 6))),
        ("tea beaker", "green", "a cream stripe"),
    ),
    (
        Cup(0.0430, 0.0565, 0.1065, 0.1052, 0.11),
        Look(YELLOW, WHITE, "plastic", label(YELLOW, RED, WHITE, "band")),
        ("snack cup", "yellow", "a red band"),
    ),
    (
        Cup(0.0340, 0.0385, 0.0814, 0.0800, 0.08),
        Look(ORANGE, ORANGE, "plastic"),
        ("tumbler", "orange", "a wide mouth"),
    ),
    (
        Cup(0.0330, 0.0375, 0.0610, 0.0580, 0.10, reach=0.0515),
        Look(PINK, WHITE, "ceramic", label(PINK, WHITE, RED, "fruit")),
        ("teacup", "pink", "a round handle"),
    ),
    (
        Cup(0.0560, 0.0590, 0.1300, 0.1240, 0.32, reach=0.1000),
        Look(WHITE, WHITE, "steel", bands((BLUE, WHITE), (1, 12))),
        ("enamel cup", "white", "a blue rim"),
    ),
    (
        Cup(0.0400, 0.0590, 0.0930, 0.0890, 0.30, reach=0.0960, belly=0.057),
        Look(BLACK, RED, "ceramic"),
        ("soup cup", "black", "a red inside"),
    ),
    (
        Cup(0.0480, 0.0590, 0.0990, 0.0950, 0.25, reach=0.0990),
        Look(STEEL, STEEL, "steel"),
        ("camping cup", "silver", "a metal handle"),
    ),
)

MODELS: Models = {"021_cup": {i: partial(cup, *row) for i, row in enumerate(ROWS)}}
