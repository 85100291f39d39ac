"""057_toycar: small cars along z, front to +z. Wheels are fixed prisms: toys that do not roll off.

The official grasps are kept in height but never closer than 1.2 cm to the table.
"""

from dataclasses import dataclass
from functools import partial

import numpy as np

from rtphys.assets.asset_model import AssetModel, Body, Part, contact
from rtphys.assets.geometry import box, cylinder
from rtphys.assets.material import Colour, matt, metal, plastic
from rtphys.assets.objects import Models
from rtphys.assets.solid import Solid
from rtphys.assets.swept import bevelled

TYRE, GLASS = matt((0.06, 0.06, 0.07)), plastic((0.12, 0.17, 0.22), 0.9)
HUB = metal((0.80, 0.81, 0.83), 0.3)
LAMP, TAIL = plastic((1.0, 0.95, 0.70), 0.8), plastic((0.85, 0.08, 0.08), 0.7)


@dataclass(frozen=True)
class Car:
    """Sizes [m], mass [kg]; the rest are shares of these."""

    width: float
    height: float
    length: float
    wheel: float  # radius [m]
    grip: tuple[float, float]  # y, z of the grasps
    mass: float


@dataclass(frozen=True)
class Shape:
    """Coachwork: convex outlines of (z, y) shares of length and height, each with its width."""

    body: tuple[tuple[tuple[tuple[float, float], ...], float], ...]
    cabin: tuple[tuple[float, float], ...]  # glass, a little narrower
    roof: tuple[tuple[float, float], ...] = ()  # painted, on the glass


def car(
    size: Car, shape: Shape, paint: Colour, extra: Colour, words: tuple[str, ...]
) -> AssetModel:
    """A toy car; `extra` paints all bodywork after the first piece."""
    w, h, length = size.width, size.height, size.length
    scale = np.array([length, h])

    def piece(outline: tuple, width: float) -> Solid:
        return bevelled(np.array(outline) * scale, width * w, 0.04 * w)

    shells = [piece(o, b) for o, b in shape.body]
    glass = piece(shape.cabin, 0.84)
    roof = [piece(shape.roof, 0.86)] if shape.roof else []
    wheels, hubs = _wheels(size)
    coats = [plastic(paint, 0.7)] + [plastic(extra, 0.6)] * (len(shells) - 1)
    lamp_y = 0.5 * (shape.body[0][0][0][1] + max(y for z, y in shape.body[0][0] if z > 0.4)) * h
    rear = (min(z for z, _ in shape.body[0][0]) + 0.003) * length
    looks = [Part(s, c, "plastic") for s, c in zip(shells, coats, strict=True)]
    looks += [Part(r, coats[0], "plastic") for r in roof]
    looks += [
        Part(glass, GLASS, "plastic"),
        Part(_pair(0.33 * shape.body[0][1] * w, lamp_y, 0.497 * length, 0.15 * w), LAMP, "plastic"),
        Part(_pair(0.34 * shape.body[0][1] * w, lamp_y, rear, 0.12 * w), TAIL, "plastic"),
        Part(_sum(wheels), TYRE, "rubber"),
        Part(_sum(hubs), HUB, "plastic"),
    ]
    y, z = size.grip
    return AssetModel(
        body=Body(tuple(looks), (*shells, glass, *roof, *wheels), size.mass),
        material="plastic",
        description=words,
        contact_points=tuple(contact((0, y, z), (0, 1, 0), (0, 0, s)) for s in (-1, 1)),
        categories=("toy car", "toy"),
    )


def _wheels(size: Car) -> tuple[list[Solid], list[Solid]]:
    """Four prisms with a facet underneath, and their hubs."""
    r, thick = size.wheel, 0.17 * size.width
    tyre = cylinder(r / np.cos(np.pi / 12), thick, 12).turned("y", 15).turned("z", 90)
    hub = cylinder(0.55 * r, thick + 0.001, 8).turned("z", 90)
    places = [
        (sx * (size.width - thick) / 2, r, sz * size.length)
        for sx in (-1, 1)
        for sz in (-0.29, 0.29)
    ]
    return [tyre.at(*p) for p in places], [hub.at(*p) for p in places]


def _pair(x: float, y: float, z: float, side: float) -> Solid:
    lamp = box(side, 0.7 * side, 0.0025).at(0, y, z)
    return lamp.at(x) + lamp.at(-x)


def _sum(solids: list[Solid]) -> Solid:
    total = solids[0]
    for s in solids[1:]:
        total = total + s
    return total


JEEP = Shape(
    (
        (((-0.47, 0.20), (0.50, 0.20), (0.50, 0.52), (0.46, 0.58), (-0.47, 0.62)), 0.90),
        (((-0.5, 0.32), (-0.46, 0.30), (-0.46, 0.62), (-0.5, 0.60)), 0.45),
    ),
    ((-0.44, 0.58), (0.16, 0.56), (0.10, 0.92), (-0.42, 0.92)),
    ((-0.44, 0.90), (0.12, 0.90), (0.10, 1.0), (-0.42, 1.0)),
)
RACER = Shape(
    (
        (
            ((-0.46, 0.16), (0.50, 0.16), (0.50, 0.28), (0.10, 0.62), (-0.40, 0.66), (-0.46, 0.6)),
            0.62,
        ),
        (((-0.50, 0.84), (-0.36, 0.84), (-0.36, 1.0), (-0.50, 1.0)), 1.0),
        (((-0.44, 0.55), (-0.40, 0.55), (-0.40, 0.90), (-0.44, 0.90)), 0.2),
    ),
    ((-0.22, 0.55), (0.14, 0.50), (-0.02, 0.86), (-0.16, 0.86)),
)
BUS = Shape(
    (
        (((-0.50, 0.16), (0.50, 0.16), (0.50, 0.48), (0.49, 0.54), (-0.50, 0.54)), 0.94),
        (((-0.49, 0.84), (0.46, 0.84), (0.44, 1.0), (-0.47, 1.0)), 0.92),
    ),
    ((-0.49, 0.5), (0.48, 0.5), (0.455, 0.88), (-0.48, 0.88)),
)
SPORTS = Shape(
    (
        (
            ((-0.49, 0.20), (0.50, 0.18), (0.50, 0.36), (0.22, 0.62), (-0.42, 0.72), (-0.49, 0.6)),
            0.94,
        ),
        (((-0.5, 0.85), (-0.4, 0.85), (-0.4, 0.95), (-0.5, 0.95)), 0.94),
        (((-0.46, 0.6), (-0.42, 0.6), (-0.42, 0.9), (-0.46, 0.9)), 0.5),
    ),
    ((-0.38, 0.66), (0.20, 0.58), (0.02, 0.97), (-0.20, 1.0)),
)
TIPPER = Shape(
    (
        (((0.12, 0.20), (0.50, 0.20), (0.50, 0.55), (0.44, 0.62), (0.12, 0.62)), 0.88),
        (((-0.50, 0.42), (0.06, 0.42), (0.10, 0.92), (-0.46, 0.82)), 0.94),
        (((-0.48, 0.20), (0.14, 0.20), (0.14, 0.44), (-0.48, 0.44)), 0.70),
    ),
    ((0.14, 0.6), (0.44, 0.6), (0.38, 0.92), (0.14, 0.94)),
    ((0.13, 0.90), (0.40, 0.90), (0.38, 1.0), (0.13, 1.0)),
)
PICKUP = Shape(
    (
        (((-0.02, 0.22), (0.50, 0.22), (0.50, 0.52), (0.44, 0.60), (-0.02, 0.64)), 0.90),
        (((-0.50, 0.22), (0.0, 0.22), (0.0, 0.60), (-0.50, 0.60)), 0.90),
    ),
    ((-0.16, 0.58), (0.24, 0.56), (0.12, 0.92), (-0.14, 0.92)),
    ((-0.17, 0.90), (0.13, 0.90), (0.11, 1.0), (-0.15, 1.0)),
)

Row = tuple[Car, Shape, Colour, Colour, tuple[str, ...]]
ROWS: tuple[Row, ...] = (
    (
        Car(0.0590, 0.0520, 0.0955, 0.0125, (0.0274, 0.0), 0.095),
        JEEP,
        (0.25, 0.45, 0.22),
        (0.15, 0.15, 0.15),
        ("green toy jeep", "toy off-road car", "green toy car", "little green jeep"),
    ),
    (
        Car(0.0446, 0.0270, 0.0955, 0.0085, (0.0140, 0.0), 0.045),
        RACER,
        (0.85, 0.10, 0.10),
        (0.95, 0.95, 0.95),
        ("red toy racing car", "toy race car", "red toy car", "racing car with a wing"),
    ),
    (
        Car(0.0475, 0.0460, 0.0960, 0.0090, (0.0260, 0.0), 0.085),
        BUS,
        (0.96, 0.74, 0.10),
        (0.96, 0.74, 0.10),
        ("yellow toy bus", "school bus toy", "small yellow bus", "yellow toy van"),
    ),
    (
        Car(0.0475, 0.0258, 0.0960, 0.0085, (0.0130, 0.0), 0.050),
        SPORTS,
        (0.10, 0.35, 0.80),
        (0.10, 0.35, 0.80),
        ("blue toy sports car", "blue toy car", "flat toy car", "little blue car"),
    ),
    (
        Car(0.0530, 0.0490, 0.0955, 0.0115, (0.0280, 0.0), 0.110),
        TIPPER,
        (0.95, 0.50, 0.08),
        (0.35, 0.36, 0.38),
        ("orange toy truck", "toy dump truck", "tipper truck toy", "orange toy lorry"),
    ),
    (
        Car(0.0510, 0.0422, 0.0958, 0.0105, (0.0220, -0.0124), 0.085),
        PICKUP,
        (0.88, 0.88, 0.90),
        (0.55, 0.10, 0.12),
        ("white toy pickup", "toy pickup truck", "white and red toy car", "small toy pickup"),
    ),
)

MODELS: Models = {"057_toycar": {i: partial(car, *row) for i, row in enumerate(ROWS)}}
