"""Materials of objects: density, friction and appearance."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from rtphys.core.errors import UnknownName

Picture = NDArray[np.uint8]  # (h, w, 3) RGB, top row first
Colour = tuple[float, float, float]  # sRGB, each 0..1


@dataclass(frozen=True)
class Substance:
    """Physical properties of a material: handbook values, rounded."""

    density: float  # [kg/m^3]
    friction: float  # [1] against a wooden table and rubber pads, static = dynamic


SUBSTANCES = {
    "aluminium": Substance(2700, 0.4),
    "bread": Substance(250, 0.6),
    "cardboard": Substance(690, 0.5),
    "ceramic": Substance(2400, 0.4),
    "fabric": Substance(400, 0.7),
    "food": Substance(950, 0.6),
    "glass": Substance(2500, 0.35),
    "leather": Substance(860, 0.6),
    "paper": Substance(800, 0.5),
    "plastic": Substance(1050, 0.4),
    "rubber": Substance(1150, 0.9),
    "soap": Substance(1000, 0.35),
    "steel": Substance(7850, 0.4),
    "wicker": Substance(450, 0.5),
    "wood": Substance(650, 0.5),
}


def substance(name: str) -> Substance:
    """The material of this name. Raises UnknownName with the nearest match."""
    if name not in SUBSTANCES:
        raise UnknownName("material", name, SUBSTANCES)
    return SUBSTANCES[name]


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
