"""018_microphone: they lie along z, tail to +z, resting on head and tail.

Sixteen grasps: eight directions about the axis at an upper station (0, 2-8) and at a lower one
(1, 9-15). On models 4 and 5 both stations are moved towards the tail, off the head: officially a
gripper would close on that. Handles and heads are prisms, so that they stay where they lie.
"""

from dataclasses import dataclass
from functools import partial

import numpy as np

from rtphys.assets.asset_model import AssetModel, Body, Part, contact, functional
from rtphys.assets.geometry import box, cylinder, lathe, rounded
from rtphys.assets.material import Colour, matt, metal, plastic
from rtphys.assets.objects import Models
from rtphys.assets.pictures import speckle
from rtphys.assets.solid import Solid, hull, together

SIDES = 16  # a facet underneath
# Directions of the grasps, in turns of 45 degrees about the axis from -x over +y.
UPPER, LOWER = (0, 1, 2, 3, 4, 5, 6, 7), (4, 5, 6, 7, 0, 1, 2, 3)


@dataclass(frozen=True)
class Microphone:
    """Sizes [m] along the axis, from the head's tip to the tail, and mass [kg]."""

    tip: float  # z of the head's end
    neck: float  # z where the handle begins
    tail: float  # z of the handle's end
    head: float  # radius of the head
    wide: float  # length of a crosswise head, 0 for a ball
    handle: tuple[float, float]  # radius at the neck and at the tail
    stations: tuple[float, float]  # z of the upper and the lower grasps
    mass: float


def microphone(size: Microphone, body: Colour, mesh: Colour, words: tuple[str, ...]) -> AssetModel:
    """A hand-held microphone, its axis leaning a little as it lies."""
    shaft = _shaft(size)
    head, hulls = _crosswise(size) if size.wide else _ball(size)
    ring = _turned([(0, -0.004), (size.handle[0] * 1.10, -0.004), (size.handle[0] * 1.10, 0.004),
                    (0, 0.004)]).at(z=size.neck + 0.002)  # fmt: skip
    switch = box(0.006, 0.003, 0.014).at(0, size.handle[0] * 0.93, size.neck + 0.030)
    end = _turned([(0, -0.003), (size.handle[1] * 0.8, -0.003), (size.handle[1] * 0.8, 0.003),
                   (0, 0.003)]).at(z=size.tail)  # fmt: skip
    grille = metal(mesh, 0.5).with_picture(speckle((1.0, 1.0, 1.0), "grille", 0.5, 24), "y")
    looks = [
        Part(shaft, plastic(body, 0.5), "aluminium", 50),
        Part(head, grille, "plastic", 50),
        Part(together(ring, end), metal((0.80, 0.80, 0.82), 0.3), "steel"),
        Part(switch, matt((0.85, 0.15, 0.12)), "plastic"),
    ]
    lie = _lying(size)
    points = _points(size)
    tail = functional((0, 0, size.tail), (0, 0, 1), (1, 0, 0))
    return AssetModel(
        body=Body(
            tuple(Part(p.solid.placed(lie), p.finish, p.material, p.crease_deg) for p in looks),
            tuple(h.placed(lie) for h in (shaft, *hulls)),
            size.mass,
        ),
        material="aluminium",
        description=words,
        contact_points=tuple(lie @ p for p in points),
        functional_points=(lie @ tail,),
        categories=("microphone", "electronics"),
    )


def _turned(profile: list[tuple[float, float]]) -> Solid:
    """A profile of (radius, z) about z, with facets below and at the sides."""
    return lathe(profile, SIDES).turned("y", 180 / SIDES).turned("x", 90)


def _shaft(size: Microphone) -> Solid:
    big, small = size.handle
    outline = [(0, size.neck), (big, size.neck), (small, size.tail), (0, size.tail)]
    return _turned(outline)


def _ball(size: Microphone) -> tuple[Solid, tuple[Solid, ...]]:
    r = size.head
    middle = size.tip + r
    reach = size.neck + 0.002 - middle
    angles = np.linspace(-np.pi / 2, 0, 5)
    front = [(r * np.cos(a), middle + r * np.sin(a)) for a in angles]
    profile = [(0, size.tip), *front[1:], (r, middle + 0.25 * reach)]
    profile += [(1.05 * size.handle[0], size.neck + 0.002), (0, size.neck + 0.002)]
    solid = _turned(profile)
    return solid, (solid,)


def _crosswise(size: Microphone) -> tuple[Solid, tuple[Solid, ...]]:
    """A drum across the handle and a short neck."""
    middle = size.tip + size.head
    soft = rounded([(0, -size.wide / 2), (size.head, -size.wide / 2), (size.head, size.wide / 2),
                    (0, size.wide / 2)], 0.35 * size.head, 2, closed=False)  # fmt: skip
    drum = lathe(soft, SIDES).turned("y", 180 / SIDES).turned("z", 90).at(z=middle)
    collar = cylinder(size.handle[0] * 1.05, size.neck + 0.004 - middle, SIDES).turned("x", 90)
    collar = collar.at(z=(size.neck + 0.004 + middle) / 2)
    return drum + collar, (hull(drum.vertices), collar)


def _lying(size: Microphone) -> np.ndarray:
    """Model frame <- axis frame: head and tail both on the ground."""
    flat = np.cos(np.pi / SIDES)
    high, low = size.head * flat, size.handle[1] * flat
    run = size.tail - (size.tip + size.head)
    lean = np.arcsin((high - low) / run)
    X = np.eye(4)
    c, s = np.cos(lean), np.sin(lean)
    X[:3, :3] = [[1, 0, 0], [0, c, -s], [0, s, c]]
    X[:3, 3] = [0, high / np.cos(lean) + (size.tip + size.head) * np.tan(lean), 0]
    return X


def _points(size: Microphone) -> list[np.ndarray]:
    def grasp(z: float, turn: int) -> np.ndarray:
        a = np.radians(45 * turn)
        return contact((0, 0, z), (-np.cos(a), np.sin(a), 0), (0, 0, -1))

    upper = [grasp(size.stations[0], t) for t in UPPER]
    lower = [grasp(size.stations[1], t) for t in LOWER]
    return [upper[0], lower[0], *upper[1:], *lower[1:]]


BLACK, SILVER, GOLD = (0.10, 0.10, 0.11), (0.78, 0.79, 0.81), (0.88, 0.72, 0.36)
BLUE, DARK, PINK = (0.16, 0.34, 0.72), (0.30, 0.31, 0.33), (0.90, 0.42, 0.58)

MODELS: Models = {
    "018_microphone": {
        0: partial(
            microphone,
            Microphone(
                -0.083, -0.037, 0.0762, 0.0272, 0.0, (0.0175, 0.0120), (-0.0044, 0.0471), 0.12
            ),
            BLACK,
            SILVER,
            ("black microphone", "microphone with a silver head", "microphone", "hand microphone"),
        ),
        4: partial(
            microphone,
            Microphone(
                -0.0276, 0.009, 0.0772, 0.0205, 0.062, (0.0150, 0.0120), (0.0260, 0.0650), 0.10
            ),
            BLUE,
            DARK,
            ("blue microphone", "microphone with a wide head", "T-shaped microphone", "blue mic"),
        ),
        5: partial(
            microphone,
            Microphone(
                -0.043, 0.003, 0.0772, 0.0255, 0.0, (0.0165, 0.0125), (0.0160, 0.0600), 0.10
            ),
            PINK,
            GOLD,
            ("pink microphone", "short microphone", "karaoke microphone", "pink and gold mic"),
        ),
    }
}
