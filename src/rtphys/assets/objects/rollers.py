"""102_roller: rolling pins.

They lie, so they collide as prisms, whose facets stand for the rolling resistance that the engine
lacks.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import partial

import numpy as np

from rtphys.assets.asset_model import AssetModel, Body, Part, contact
from rtphys.assets.geometry import extrude, lathe, rounded
from rtphys.assets.material import Finish, matt, plastic
from rtphys.assets.objects import Models
from rtphys.assets.pictures import grain
from rtphys.assets.solid import Solid

SIDES = 16  # a multiple of 4 puts a facet underneath and on both flanks; at most 24


@dataclass(frozen=True)
class Pin:
    """Sizes [m] along and across the pin."""

    length: float
    radius: float  # apothem of the body
    body: float  # length of the thick part
    handle: float  # radius of the handles
    along: str  # "x" or "z": the axis it lies along in its model frame
    height: float  # y of the axis in the model frame
    grips: tuple[float, float]  # signed distance of contact points 0 and 1 from the middle


def roller(pin: Pin, wood: Finish, ends: Finish, words: tuple[str, ...]) -> AssetModel:
    """A turned body between two handles."""
    half, body = pin.length / 2, pin.body / 2
    barrel = [(0, -body), (pin.radius, -body), (pin.radius, body), (0, body)]
    barrel = rounded(barrel, 0.3 * pin.radius, 2, closed=False)
    neck = 0.55 * pin.handle
    looks = [Part(_lying(_turned(barrel), pin), wood, "wood", 45)]
    for s in (-1, 1):
        stub = [(0, body), (neck, body), (pin.handle, body + 0.012), (pin.handle, half - 0.006)]
        stub += [(0.6 * pin.handle, half), (0, half)]
        shape = _turned(rounded(stub, 0.004, 2, closed=False))
        shape = shape if s > 0 else shape.scaled(1, -1, 1)
        looks.append(Part(_lying(shape, pin), ends, "wood", 45))
    hulls = [_prism(pin.radius, -body, body)]
    hulls += [_prism(pin.handle, *reach) for reach in ((-half, -body), (body, half))]
    return AssetModel(
        body=Body(tuple(looks), tuple(_lying(h, pin) for h in hulls)),
        material="wood",
        description=words,
        contact_points=tuple(_grip(pin, d) for d in pin.grips),
        categories=("rolling pin", "kitchen"),
        stable=False,
    )


def _turned(profile: Sequence[Sequence[float]] | np.ndarray) -> Solid:
    return lathe(profile, SIDES).turned("y", 180 / SIDES)


def _prism(apothem: float, start: float, end: float) -> Solid:
    angles = 2 * np.pi * (np.arange(SIDES) + 0.5) / SIDES
    radius = apothem / np.cos(np.pi / SIDES)
    outline = radius * np.stack([np.cos(angles), np.sin(angles)], axis=1)
    return extrude(outline, end - start).at(y=start)


def _lying(solid: Solid, pin: Pin) -> Solid:
    turned = solid.turned("x", 90) if pin.along == "z" else solid.turned("z", -90)
    return turned.at(y=pin.height)


def _grip(pin: Pin, distance: float) -> np.ndarray:
    """A grasp from above; the camera's up axis points along the pin, away from its middle."""
    axis = np.array([1.0, 0, 0]) if pin.along == "x" else np.array([0, 0, 1.0])
    return contact(distance * axis + [0, pin.height, 0], (0, 1, 0), np.sign(distance) * axis)


BEECH = matt((0.82, 0.62, 0.40)).with_picture(grain((1.0, 1.0, 1.0), "beech", 0.15), "cylinder")
WALNUT = matt((0.42, 0.25, 0.14))

MODELS: Models = {
    "102_roller": {
        0: partial(
            roller,
            Pin(0.2318, 0.01735, 0.126, 0.0125, "z", 0.0156, (-0.0875, 0.0822)),
            BEECH,
            WALNUT,
            (
                "wooden rolling pin",
                "rolling pin with dark handles",
                "roller",
                "baking pin",
            ),
        ),
        1: partial(
            roller,
            Pin(0.2290, 0.01960, 0.130, 0.0135, "z", 0.0178, (-0.0940, 0.0940)),
            plastic((0.92, 0.92, 0.90), 0.6),
            plastic((0.15, 0.35, 0.70), 0.5),
            ("white rolling pin", "rolling pin with blue handles", "roller", "plastic rolling pin"),
        ),
        2: partial(
            roller,
            Pin(0.2511, 0.01550, 0.136, 0.0115, "x", 0.0113, (0.0886, -0.0880)),
            plastic((0.30, 0.60, 0.42), 0.4),
            matt((0.80, 0.62, 0.42)),
            (
                "green rolling pin",
                "silicone rolling pin",
                "roller",
                "green baking roller",
            ),
        ),
    }
}
