"""099_fan: small table fans that blow to +z; held by the rim of the cage, across its depth."""

from dataclasses import dataclass
from functools import partial

import numpy as np

from rtphys.assets.asset_model import AssetModel, Body, Part, contact
from rtphys.assets.geometry import box, cone, cylinder, rounded_box, tube
from rtphys.assets.material import Colour, metal, plastic
from rtphys.assets.objects import Models
from rtphys.assets.solid import Solid, hull, together

SIDES = 16


@dataclass(frozen=True)
class Fan:
    """Sizes [m] and mass [kg]; the foot is a box if `square`, otherwise round."""

    radius: float  # of the cage
    deep: float  # cage
    axis_z: float  # middle of the cage, at which it is held
    foot: tuple[float, float, float]  # x, y, z
    square: bool
    height: float
    grip: float  # y
    blades: int
    mass: float


def fan(size: Fan, body: Colour, blade: Colour, words: tuple[str, ...]) -> AssetModel:
    """A fan: a weighted foot, a stem, a cage of bars with blades inside."""
    r, z, y = size.radius, size.axis_z, size.height - size.radius
    coat = plastic(body, 0.6)
    foot, stem = _foot(size), _stem(size, y)
    motor = cylinder(0.32 * r, 0.5 * size.deep, 16).turned("x", 90).at(0, y, z - 0.18 * size.deep)
    button = cylinder(0.006, 0.006, 10).at(0, size.foot[1], 0.36 * size.foot[2])
    band = _hoop(r, 0.3 * size.deep).at(0, y, z)
    bars = metal((0.86, 0.87, 0.89), 0.3)
    looks = (
        Part(together(foot, stem, motor), coat, "plastic"),
        Part(_bars(size).at(0, y, z), bars, "aluminium", 50),
        Part(band, coat, "plastic"),
        Part(_rotor(size).at(0, y, z) + button, plastic(blade, 0.6), "plastic"),
    )
    apothem = r / np.cos(np.pi / SIDES)
    cage = cylinder(apothem, size.deep, SIDES).turned("y", 180 / SIDES).turned("x", 90).at(0, y, z)
    grip = (0, size.grip, z)
    return AssetModel(
        body=Body(looks, (foot, stem, cage), size.mass),
        material="plastic",
        description=words,
        contact_points=tuple(contact(grip, (0, 1, 0), (s, 0, 0)) for s in (1, -1)),
        categories=("fan", "electronics"),
    )


def _bars(size: Fan) -> Solid:
    """Rims, inner rings and spokes, in front and behind, about the cage's middle."""
    r, half = size.radius, size.deep / 2
    spoke = box(0.0018, 2 * (r - 0.002), 0.0018)
    spokes = together(*(spoke.turned("z", a) for a in (0.0, 45.0, 90.0, 135.0)))
    rim, ring = _ring(r - 0.0025, 0.0025), _ring(0.55 * r, 0.0012)
    side = together(rim.at(z=half - 0.0025), ring.at(z=half - 0.002), spokes.at(z=half - 0.002))
    return side + side.scaled(1, 1, -1)


def _rotor(size: Fan) -> Solid:
    """Hub and blades about the cage's middle."""
    r, deep = size.radius, size.deep
    hub = cylinder(0.17 * r, 0.7 * deep, 12).turned("x", 90).at(z=0.12 * deep)
    turns = [float(k * 360 / size.blades) for k in range(size.blades)]
    return together(hub, *(_blade(r, deep).turned("z", a) for a in turns))


def _foot(size: Fan) -> Solid:
    x, y, z = size.foot
    if size.square:
        return rounded_box(x, y, z, 0.4 * y, 2).at(y=y / 2)
    return cone(0.5, 0.42, y, 24).scaled(x, 1, z)


def _stem(size: Fan, axis_y: float) -> Solid:
    """The stem from the foot to the back of the cage. Convex."""
    low = box(0.024, 0.010, 0.028).at(0, size.foot[1] - 0.004, -0.10 * size.foot[2])
    back = size.axis_z - size.deep / 2
    high = box(0.018, 0.020, 0.010).at(0, axis_y, back)
    return hull([*low.vertices, *high.vertices])


def _ring(radius: float, wire: float) -> Solid:
    angles = 2 * np.pi * (np.arange(SIDES) + 0.5) / SIDES
    path = radius * np.stack([np.cos(angles), np.sin(angles), 0 * angles], axis=1)
    return tube(path, wire, 4, closed=True)


def _hoop(radius: float, deep: float) -> Solid:
    """The band around the cage, where the fan is grasped."""
    turned = cylinder(radius, deep, SIDES) - cylinder(0.95 * radius, 2 * deep, SIDES)
    return turned.turned("y", 180 / SIDES).turned("x", 90)


def _blade(radius: float, deep: float) -> Solid:
    """One twisted blade along +y."""
    root = box(0.16 * radius, 0.002, 0.0025).turned("y", 35).at(0, 0.16 * radius, 0)
    tip = box(0.62 * radius, 0.002, 0.0025).turned("y", 28).at(0.10 * radius, 0.86 * radius, 0)
    return hull([*root.vertices, *tip.vertices]).at(z=0.05 * deep)


MODELS: Models = {
    "099_fan": {
        4: partial(
            fan,
            Fan(0.0550, 0.036, 0.0215, (0.096, 0.014, 0.083), True, 0.1545, 0.146, 4, 0.26),
            (0.25, 0.62, 0.72),
            (0.95, 0.95, 0.95),
            ("blue desk fan", "small fan", "turquoise fan", "fan with a square foot"),
        ),
        5: partial(
            fan,
            Fan(0.0660, 0.042, 0.0260, (0.112, 0.018, 0.110), False, 0.1630, 0.154, 3, 0.34),
            (0.93, 0.93, 0.92),
            (0.90, 0.35, 0.20),
            ("white desk fan", "table fan", "fan with orange blades", "round white fan"),
        ),
    }
}
