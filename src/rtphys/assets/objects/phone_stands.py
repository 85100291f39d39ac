"""078_phonestand: a foot, a neck and a cradle that leans back, narrower than any phone.

The fingers that put a phone there stand beside the back plate; a lip keeps the phone from sliding.
The grasps are at the plate's upper edge: the official ones close across a neck that is too deep.
"""

from dataclasses import dataclass
from functools import partial

import numpy as np

from rtphys.assets.asset_model import AssetModel, Body, Part, contact, functional
from rtphys.assets.geometry import box, rounded_box
from rtphys.assets.material import Colour, metal, plastic
from rtphys.assets.objects import Models
from rtphys.assets.solid import Solid, hull

LEAN = np.array([0.0, 0.888, -0.459])  # up along the back plate
FRONT = np.array([0.0, 0.459, 0.888])  # out of it, towards the viewer
PLATE = 0.005  # [m] thickness


@dataclass(frozen=True)
class Stand:
    """Sizes [m] and mass [kg]."""

    foot: tuple[float, float, float]  # x, y, z
    cradle: tuple[float, float]  # y, z of the functional point
    plate: tuple[float, float]  # width and length of the back
    lip: tuple[float, float]  # width and reach of the ledge
    mass: float


def stand(size: Stand, body: Colour, metallic: bool, words: tuple[str, ...]) -> AssetModel:
    """A phone stand for a desk."""
    finish = metal(body, 0.4) if metallic else plastic(body, 0.5)
    fx, fy, fz = size.foot
    foot = rounded_box(fx, fy, fz, 0.45 * fy, 2).at(y=fy / 2)
    wide, tall = size.plate
    ledge, reach = size.lip
    back = _plate(size, (wide, tall + PLATE, PLATE), (tall - PLATE) / 2, -PLATE / 2)
    shelf = _plate(size, (ledge, PLATE, reach + PLATE), -PLATE / 2, (reach - PLATE) / 2)
    rim = _plate(size, (ledge, 0.010, 0.003), 0.005 - PLATE, reach + 0.0015)
    # The neck runs from the rear of the foot to the middle of the plate.
    upper = _plate(size, (0.7 * wide, 0.22 * tall, PLATE), 0.20 * tall, -1.4 * PLATE)
    root = box(0.8 * wide, 0.4 * fy, 0.030).at(0, 0.75 * fy, -fz / 2 + 0.022)
    neck = hull([*upper.vertices, *root.vertices])
    pad = _plate(size, (0.8 * wide, 0.6 * tall, 0.0012), 0.55 * tall, 0.0)
    looks = (
        Part(foot, finish, "aluminium" if metallic else "plastic"),
        Part(back + shelf + rim + neck, finish, "aluminium" if metallic else "plastic"),
        Part(pad, plastic((0.10, 0.10, 0.11), 0.1), "rubber"),
    )
    edge = np.array([0, *size.cradle]) + (tall - 0.004) * LEAN - PLATE / 2 * FRONT
    parts = (box(fx, fy, fz).at(y=fy / 2), back, shelf, rim, neck)
    return AssetModel(
        body=Body(looks, parts, size.mass),
        material="rubber",
        description=words,
        contact_points=tuple(contact(edge, LEAN, (s, 0, 0)) for s in (1, -1)),
        functional_points=(functional((0, *size.cradle), LEAN, FRONT),),
        categories=("phone stand", "office"),
    )


def _plate(size: Stand, sizes: tuple[float, float, float], along: float, out: float) -> Solid:
    """A cuboid (x, along the plate, out of it) with its middle at these distances."""
    X = np.eye(4)
    X[:3, 1], X[:3, 2] = LEAN, FRONT
    X[:3, 3] = np.array([0, *size.cradle]) + along * LEAN + out * FRONT
    return box(*sizes).placed(X)


MODELS: Models = {
    "078_phonestand": {
        1: partial(
            stand,
            Stand(
                (0.0765, 0.012, 0.136),
                (0.1146, 0.0336),
                (0.046, 0.084),
                (0.060, 0.022),
                0.42,
            ),
            (0.74, 0.75, 0.78),
            True,
            ("silver phone stand", "metal phone holder", "tall phone stand", "phone stand"),
        ),
        2: partial(
            stand,
            Stand(
                (0.085, 0.016, 0.128),
                (0.0986, 0.0352),
                (0.042, 0.066),
                (0.056, 0.022),
                0.34,
            ),
            (0.93, 0.58, 0.20),
            False,
            ("orange phone stand", "plastic phone holder", "phone stand", "small phone stand"),
        ),
    }
}
