"""095_glue: bottles and a stick, upright. 165_tooth-paste: tubes that lie on their flat side."""

from dataclasses import dataclass
from functools import partial

import numpy as np

from rtphys.assets.asset_model import AssetModel, Body, Part
from rtphys.assets.geometry import box, cone, lathe, rounded
from rtphys.assets.lettering import write
from rtphys.assets.material import Colour, Picture, plastic
from rtphys.assets.objects import Models
from rtphys.assets.pictures import plain, to_picture
from rtphys.assets.solid import Solid, hull
from rtphys.assets.swept import loft, oval, rod, slabs

SIDES = 20


@dataclass(frozen=True)
class Glue:
    """Sizes [m]: body radius and height, cap radius, whole height; mass [kg]."""

    radius: float
    shoulder: float
    cap: float
    height: float
    mass: float


def glue(size: Glue, body: Colour, cap: Colour, words: tuple[str, ...]) -> AssetModel:
    """A bottle with a pointed cap, or a stick where the cap is as wide as the body."""
    r, low, top = size.radius, size.shoulder, size.height
    stick = size.cap > 0.9 * r
    profile = [(0, 0), (r, 0), (r, low), (size.cap, low + 0.35 * (top - low) * (not stick))]
    profile.append((0, profile[-1][1] + 0.0005))
    flask = lathe(rounded(profile, 0.15 * r, 2, closed=False), SIDES)
    start = profile[-1][1] - 0.002
    lid = cone(size.cap, size.cap if stick else 0.25 * size.cap, top - start, SIDES).at(y=start)
    label = lathe([(0, 0.20 * low), (1.012 * r, 0.20 * low), (1.012 * r, 0.78 * low),
                   (0, 0.78 * low)], SIDES)  # fmt: skip
    print_ = plastic((1, 1, 1), 0.4).with_picture(_label("GLUE", cap), "cylinder")
    looks = (
        Part(flask, plastic(body, 0.5), "plastic"),
        Part(label, print_, "paper"),
        Part(lid, plastic(cap, 0.5), "plastic"),
    )
    parts = (lathe([(0, 0), (r, 0), (r, low), (0, low)], SIDES), hull(flask.vertices), lid)
    return _thing(looks, parts[1:], size.mass, words, ("glue", "office"))


def tube(
    length: float, wide: float, colour: Colour, cap: Colour, words: tuple[str, ...]
) -> AssetModel:
    """A tube: round at the cap (+z), flat at its end."""
    r = 0.5 * wide * 0.72
    places = np.linspace(0, 1, 5)
    rings = []
    for t in places:
        tall = 0.006 + (2 * r - 0.006) * np.sin(0.5 * np.pi * min(1.0, 1.15 * t)) ** 0.8
        rings.append(oval(wide * (1 - 0.28 * t), tall, (t - 0.55) * length, 14)
                     + np.array([0, tall / 2, 0]))  # fmt: skip
    rings = np.array(rings)
    body = loft(rings)
    end = 0.45 * length
    lid = rod(0.72 * r, end - 0.001, end + 0.022, 12)
    crimp = box(wide, 0.005, 0.012).at(0, 0.0035, -0.55 * length - 0.004)
    band = loft(rings[1:4] * [1.004, 1.008, 0.8])
    shown = plain((0.97, 0.97, 0.97), 24, 48)
    shown[6:12], shown[30:42] = colour, colour
    page = plastic((1, 1, 1), 0.5).with_picture(to_picture(write(shown, "DENT", 18, cap)), "y")
    looks = (
        Part(body + crimp, plastic(colour, 0.6), "plastic", 50),
        Part(band, page, "plastic", 50),
        Part(lid, plastic(cap, 0.5), "plastic"),
    )
    return _thing(
        looks, (*slabs(rings, (0, 2, 4)), crimp, lid), 0.11, words, ("tooth paste", "bathroom")
    )


def _label(word: str, ink: Colour) -> Picture:
    """A label around the bottle; its word faces +z, three quarters along the picture."""
    canvas = plain((0.97, 0.96, 0.92), 64, 24)
    canvas[:3], canvas[-3:] = ink, ink
    return to_picture(np.roll(write(canvas, word, 9, ink), 16, axis=1))


def _thing(
    looks: tuple[Part, ...],
    parts: tuple[Solid, ...],
    mass: float,
    words: tuple[str, ...],
    kinds: tuple[str, ...],
) -> AssetModel:
    return AssetModel(
        body=Body(looks, parts, mass),
        material="plastic",
        description=words,
        categories=kinds,
    )


WHITE, ORANGE, BLUE = (0.94, 0.94, 0.93), (0.94, 0.50, 0.10), (0.14, 0.34, 0.75)
YELLOW, RED, GREEN = (0.97, 0.85, 0.20), (0.80, 0.13, 0.12), (0.20, 0.60, 0.35)

MODELS: Models = {
    "095_glue": {
        2: partial(
            glue,
            Glue(0.0330, 0.125, 0.014, 0.190, 0.26),
            WHITE,
            ORANGE,
            ("glue bottle", "white glue bottle", "bottle of glue", "glue with an orange cap"),
        ),
        5: partial(
            glue,
            Glue(0.0240, 0.098, 0.023, 0.150, 0.09),
            YELLOW,
            RED,
            ("glue stick", "yellow glue stick", "big glue stick", "glue stick with a red cap"),
        ),
        6: partial(
            glue,
            Glue(0.0210, 0.105, 0.010, 0.152, 0.10),
            WHITE,
            BLUE,
            ("slim glue bottle", "small glue bottle", "glue with a blue cap", "bottle of glue"),
        ),
    },
    "165_tooth-paste": {
        0: partial(
            tube,
            0.140,
            0.046,
            BLUE,
            RED,
            ("toothpaste", "blue toothpaste", "blue tube", "tube of paste"),
        ),
        1: partial(
            tube,
            0.115,
            0.042,
            GREEN,
            BLUE,
            ("green toothpaste", "green tube", "small tube", "mint paste"),
        ),
        2: partial(
            tube,
            0.150,
            0.050,
            RED,
            WHITE,
            ("red toothpaste", "red tube", "large tube", "red paste"),
        ),
    },
}
