"""074_displaystand: low stands with a flat top, for showing objects."""

from dataclasses import dataclass
from functools import partial

import numpy as np

from rtphys.assets.asset_model import AssetModel, Body, Part, functional
from rtphys.assets.geometry import box, rounded_box
from rtphys.assets.material import Colour, Finish, matt, plastic, tint
from rtphys.assets.objects import Models
from rtphys.assets.pictures import grain, speckle
from rtphys.assets.solid import Solid, hull
from rtphys.assets.swept import oval


@dataclass(frozen=True)
class Stand:
    """Sizes [m] and mass [kg]."""

    x: float
    y: float
    z: float
    mass: float


def bench(size: Stand, top: Finish, legs: Colour, words: tuple[str, ...]) -> AssetModel:
    """A board on two side walls."""
    board = box(size.x, 0.014, size.z).at(y=size.y - 0.007)
    walls = [
        box(0.012, size.y - 0.013, 0.94 * size.z).at(s * (size.x / 2 - 0.016), (size.y - 0.013) / 2)
        for s in (-1, 1)
    ]
    looks = (Part(board, top, "wood"), Part(walls[0] + walls[1], matt(legs), "wood"))
    return _thing(size, looks, (board, *walls), "wood", words)


def steps(size: Stand, body: Finish, rim: Colour, words: tuple[str, ...]) -> AssetModel:
    """A wide plinth with a smaller one on it; the top is the smaller one's."""
    low = rounded_box(size.x, 0.55 * size.y, size.z, 0.003, 1).at(y=0.275 * size.y)
    high = rounded_box(0.80 * size.x, 0.5 * size.y, 0.80 * size.z, 0.003, 1).at(y=0.75 * size.y)
    band = box(1.001 * size.x, 0.006, 1.001 * size.z).at(y=0.006)
    looks = (Part(low + high, body, "plastic"), Part(band, plastic(rim, 0.6), "plastic"))
    return _thing(size, looks, (low, high), "plastic", words)


def drum(size: Stand, body: Finish, rim: Colour, words: tuple[str, ...]) -> AssetModel:
    """An oval plinth."""

    def layer(grow: float, start: float, end: float) -> Solid:
        rings = [oval(grow * size.x, grow * size.z, h, 24) for h in (start, end)]
        return hull(np.vstack(rings)[:, [0, 2, 1]])

    core = layer(0.985, 0.001, size.y - 0.001)
    plates = layer(1.0, 0.0, 0.008) + layer(1.0, size.y - 0.010, size.y)
    looks = (Part(core, body, "plastic"), Part(plates, plastic(rim, 0.6), "plastic"))
    return _thing(size, looks, (layer(1.0, 0.0, size.y),), "plastic", words)


def slab(size: Stand, body: Finish, felt: Colour, words: tuple[str, ...]) -> AssetModel:
    """A low block with a felt inlay and a chamfered edge."""
    block = rounded_box(size.x, size.y, size.z, 0.006, 1).at(y=size.y / 2)
    inlay = box(size.x - 0.024, 0.001, size.z - 0.024).at(y=size.y)
    looks = (Part(block, body, "wood"), Part(inlay, matt(felt), "fabric"))
    return _thing(size, looks, (block,), "wood", words)


def _thing(
    size: Stand,
    looks: tuple[Part, ...],
    parts: tuple[Solid, ...],
    material: str,
    words: tuple[str, ...],
) -> AssetModel:
    return AssetModel(
        body=Body(looks, parts, size.mass),
        material=material,
        description=words,
        functional_points=(functional((0, size.y, 0), (0, 1, 0), (1, 0, 0)),),
        categories=("display stand", "shop"),
    )


OAK = matt((0.78, 0.58, 0.36)).with_picture(grain((1.0, 1.0, 1.0), "display oak", 0.16), "y")
WALNUT = matt((0.45, 0.28, 0.17)).with_picture(grain((1.0, 1.0, 1.0), "display walnut", 0.2), "y")
STONE = plastic((0.80, 0.80, 0.82), 0.5).with_picture(
    speckle((1.0, 1.0, 1.0), "display stone", 0.18), "cylinder"
)

MODELS: Models = {
    "074_displaystand": {
        0: partial(
            bench,
            Stand(0.193, 0.072, 0.106, 0.36),
            OAK,
            (0.62, 0.44, 0.26),
            ("wooden display stand", "wooden bench", "small wooden table", "display riser"),
        ),
        1: partial(
            steps,
            Stand(0.193, 0.0717, 0.123, 0.55),
            plastic((0.94, 0.94, 0.93), 0.5),
            (0.75, 0.62, 0.35),
            ("white display stand", "white podium", "stepped display stand", "two-step plinth"),
        ),
        2: partial(
            drum,
            Stand(0.191, 0.0710, 0.131, 0.70),
            STONE,
            tint((0.80, 0.80, 0.82), 0.6),
            ("oval display stand", "grey stone plinth", "round podium", "oval stone stand"),
        ),
        3: partial(
            slab,
            Stand(0.193, 0.0431, 0.0620, 0.30),
            plastic((0.10, 0.10, 0.11), 0.7),
            (0.45, 0.10, 0.14),
            ("black display stand", "narrow display block", "black riser", "low black stand"),
        ),
        4: partial(
            slab,
            Stand(0.193, 0.0412, 0.1370, 0.58),
            WALNUT,
            (0.86, 0.82, 0.72),
            ("dark wooden stand", "flat display stand", "wide display block", "walnut stand"),
        ),
    }
}
