"""106_skillet: frying pans. The pan lies towards +z, the handle points to -z.

Two fingers on a thin handle hold about 0.15 N m against turning, where an official pan, held 15 cm
from its middle, needs three times that: so handles are thick and heavy, and the contact point is
3 cm nearer to the pan.
"""

from dataclasses import dataclass
from functools import partial

from rtphys.assets.asset_model import AssetModel, Body, Part, contact, functional
from rtphys.assets.geometry import box, cylinder, rounded_box
from rtphys.assets.material import Colour, metal, plastic
from rtphys.assets.objects import Models
from rtphys.assets.solid import together
from rtphys.assets.vessel import Vessel
from rtphys.assets.words import phrases

GRIP = (0.0006, 0.0283, -0.0500)  # [m] the contact point, in the middle of the handle
END = -0.146  # [m] z of the handle's end


@dataclass(frozen=True)
class Skillet:
    """Sizes [m]."""

    foot: float  # radius
    rim: float  # radius
    height: float
    centre: float  # z of the pan's axis
    middle: float  # y of the functional point
    handle: float  # width
    mass: float  # [kg]


def skillet(size: Skillet, pan: Colour, coat: Colour, grip: Colour, word: str) -> AssetModel:
    """A pan with a coated inside and a flat handle."""
    vessel = Vessel(((size.foot, 0.0), (size.rim, size.height)), 0.0035, 0.004)
    start = size.centre - vessel.radius(GRIP[1])
    length = start + 0.004 - END
    bar = (GRIP[0], GRIP[1], start + 0.004 - 0.5 * length)
    sleeve = rounded_box(size.handle, 0.022, 0.86 * length, 0.005, 2)
    sleeve = sleeve.at(GRIP[0], GRIP[1], END + 0.43 * length)
    block = box(size.handle, 0.022, 0.86 * length).at(GRIP[0], GRIP[1], END + 0.43 * length)
    neck = box(0.6 * size.handle, 0.008, length - 0.01).at(*bar).at(z=0.005)
    high = size.height - 0.007
    inside = size.centre - vessel.radius(high) + vessel.wall
    rivets = [cylinder(0.004, 0.002, 8).turned("x", 90).at(x, high, inside) for x in (-0.01, 0.01)]
    looks = (
        Part(vessel.shell().at(z=size.centre) + neck, metal(pan, 0.4), "aluminium", 50),
        Part(vessel.liner().at(z=size.centre), plastic(coat, 0.4), "aluminium", 50),
        Part(together(sleeve, *rivets), plastic(grip, 0.2), "aluminium"),
    )
    hulls = (*(p.at(z=size.centre) for p in vessel.parts()), neck, block)
    return AssetModel(
        body=Body(looks, hulls, size.mass),
        material="aluminium",
        description=phrases("skillet", word, "a long handle", "frying pan"),
        contact_points=(contact(GRIP, (0, 1, 0), (0, 0, 1)),),
        functional_points=(functional((0, size.middle, size.centre), (0, 1, 0), (1, 0, 0)),),
        categories=("skillet", "kitchen"),
    )


BLACK, IRON, STEEL = (0.10, 0.10, 0.11), (0.20, 0.20, 0.21), (0.74, 0.75, 0.78)
RED, BROWN, CREAM = (0.72, 0.14, 0.12), (0.46, 0.29, 0.16), (0.88, 0.84, 0.74)
GREEN = (0.25, 0.42, 0.34)

MODELS: Models = {
    "106_skillet": {
        0: partial(
            skillet,
            Skillet(0.068, 0.0825, 0.0378, 0.0712, 0.0182, 0.030, 0.22),
            BLACK, IRON, BLACK, "black",
        ),
        1: partial(
            skillet,
            Skillet(0.066, 0.0805, 0.0490, 0.0531, 0.0060, 0.030, 0.24),
            RED, BLACK, BROWN, "red",
        ),
        2: partial(
            skillet,
            Skillet(0.072, 0.0840, 0.0600, 0.0664, 0.0060, 0.030, 0.23),
            STEEL, STEEL, BLACK, "silver",
        ),
        3: partial(
            skillet,
            Skillet(0.070, 0.0870, 0.0418, 0.0705, 0.0060, 0.032, 0.22),
            GREEN, CREAM, BROWN, "green",
        ),
    }
}  # fmt: skip
