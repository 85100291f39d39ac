"""Materials of objects: density and appearance."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from rtphys.core.errors import UnknownName

Picture = NDArray[np.uint8]  # (h, w, 3) RGB, top row first
Colour = tuple[float, float, float]  # sRGB, each 0..1


DENSITIES = {
    "aluminium": 2700.0,
    "bread": 250.0,
    "cardboard": 690.0,
    "ceramic": 2400.0,
    "fabric": 400.0,
    "food": 950.0,
    "glass": 2500.0,
    "leather": 860.0,
    "paper": 800.0,
    "plastic": 1050.0,
    "rubber": 1150.0,
    "soap": 1000.0,
    "steel": 7850.0,
    "wicker": 450.0,
    "wood": 650.0,
}
"""[kg/m^3] by material: handbook values, rounded."""


def density(material: str) -> float:
    """Density of a material [kg/m^3]. Raises UnknownName with the nearest match."""
    if material not in DENSITIES:
        raise UnknownName("material", material, DENSITIES)
    return DENSITIES[material]


@dataclass(frozen=True, eq=False)
class Finish:
    """Appearance of a surface. Parts with the same Finish *object* are drawn in one call."""

    colour: Colour = (0.8, 0.8, 0.8)
    metallic: float = 0.0
    roughness: float = 0.6
    picture: Picture | None = None  # multiplies the colour; keep it within 64 x 64
    projection: str = "cylinder"  # "cylinder" about y; "x", "y" or "z": seen along that axis

    def with_picture(self, picture: Picture, projection: str) -> "Finish":
        """The same surface with a picture on it."""
        return Finish(self.colour, self.metallic, self.roughness, picture, projection)


def plastic(colour: Colour, gloss: float = 0.5) -> Finish:
    """Coloured plastic; gloss 0 is matt, 1 shiny."""
    return Finish(colour, 0.0, 0.9 - 0.7 * gloss)


def metal(colour: Colour = (0.75, 0.76, 0.78), roughness: float = 0.35) -> Finish:
    """Bare metal, but not fully metallic: without an environment map that would look black."""
    return Finish(colour, 0.35, roughness)


def matt(colour: Colour) -> Finish:
    """A matt surface: paper, cloth, rubber, raw wood."""
    return Finish(colour, 0.0, 0.95)


def tint(colour: Colour, factor: float) -> Colour:
    """A colour made darker (factor below 1) or lighter (above 1)."""
    r, g, b = (min(1.0, max(0.0, c * factor)) for c in colour)
    return (r, g, b)
