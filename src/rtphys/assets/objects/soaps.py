"""107_soap: bars along x, plain, oval, on a dish and half wrapped.

Grasps at half height: the official one of model 0 lies on the table.
"""

from functools import partial

import numpy as np

from rtphys.assets.asset_model import AssetModel, Body, Part, contact
from rtphys.assets.geometry import box, rounded_box
from rtphys.assets.lettering import dots
from rtphys.assets.material import Colour, plastic, tint
from rtphys.assets.objects import Models
from rtphys.assets.solid import Solid, hull, together
from rtphys.assets.swept import oval

Size = tuple[float, float, float]  # x, y, z [m]


def bar(size: Size, colour: Colour, words: tuple[str, ...]) -> AssetModel:
    """A new bar with its name stamped on top."""
    x, y, z = size
    solid = rounded_box(x, y, z, 0.3 * y, 2).at(y=y / 2)
    letters = _letters(0.60 * x, 0.36 * z, y)
    looks = (Part(solid, plastic(colour, 0.55), "soap", 50), _raised(letters, colour))
    return _thing(looks, (solid,), 0.45 * y, words)


def pebble(size: Size, colour: Colour, words: tuple[str, ...]) -> AssetModel:
    """An oval bar, flat below."""
    x, y, z = size
    rings = [(0.86, 0.0), (1.0, 0.30 * y), (1.0, 0.55 * y), (0.88, 0.86 * y), (0.66, y)]
    solid = hull(np.vstack([oval(k * x, k * z, h, 20, 2.3) for k, h in rings])[:, [0, 2, 1]])
    looks = (
        Part(solid, plastic(colour, 0.6), "soap", 50),
        _raised(_letters(0.44 * x, 0.30 * z, y), colour),
    )
    return _thing(looks, (solid,), 0.45 * y, words)


def dished(size: Size, colour: Colour, dish: Colour, words: tuple[str, ...]) -> AssetModel:
    """A bar on a dish with a rim; grasps are on the bar."""
    x, y, z = size
    foot = rounded_box(0.9 * x, 0.35 * y, 0.86 * z, 0.003, 1).at(y=0.175 * y)
    rim = rounded_box(x, 0.20 * y, z, 0.003, 1).at(y=0.34 * y)
    soap = rounded_box(0.82 * x, 0.60 * y, 0.74 * z, 0.2 * y, 2).at(y=0.70 * y)
    looks = (
        Part(foot + rim, plastic(dish, 0.7), "plastic"),
        Part(soap, plastic(colour, 0.55), "soap", 50),
        _raised(_letters(0.52 * x, 0.30 * z, y), colour),
    )
    return _thing(looks, (foot, rim, soap), 0.5 * y, words)


def wrapped(size: Size, colour: Colour, paper: Colour, words: tuple[str, ...]) -> AssetModel:
    """A bar with a paper band around its middle."""
    x, y, z = size
    solid = rounded_box(0.985 * x, 0.97 * y, 0.97 * z, 0.22 * y, 2).at(y=0.485 * y)
    band = rounded_box(0.62 * x, y, z, 0.20 * y, 2).at(y=y / 2)
    looks = (
        Part(solid, plastic(colour, 0.55), "soap", 50),
        Part(band, plastic(paper, 0.2), "paper", 50),
        Part(_letters(0.44 * x, 0.30 * z, y), plastic((0.97, 0.97, 0.95), 0.3), "paper"),
    )
    return _thing(looks, (solid, band), 0.45 * y, words)


def _letters(width: float, depth: float, top: float) -> Solid:
    """SOAP in small bricks, seen from above with +z below; each run of dots is one brick."""
    pattern = dots("SOAP")
    rows, columns = pattern.shape
    cell, line = width / columns, depth / rows
    bricks = []
    for r in range(rows):
        edges = np.flatnonzero(np.diff(np.r_[0, pattern[r].astype(int), 0]))
        for start, end in edges.reshape(-1, 2):
            brick = box((end - start) * cell, 0.0012, line)
            bricks.append(
                brick.at(((start + end) / 2) * cell - width / 2, top, (r + 0.5) * line - depth / 2)
            )
    return together(*bricks)


def _raised(letters: Solid, colour: Colour) -> Part:
    return Part(letters, plastic(tint(colour, 0.62), 0.4), "soap")


def _thing(
    looks: tuple[Part, ...], parts: tuple[Solid, ...], grip: float, words: tuple[str, ...]
) -> AssetModel:
    return AssetModel(
        body=Body(looks, parts),
        material="soap",
        description=words,
        contact_points=tuple(contact((0, grip, 0), (0, 1, 0), (s, 0, 0)) for s in (1, -1)),
        categories=("soap", "bathroom"),
    )


MODELS: Models = {
    "107_soap": {
        0: partial(
            bar,
            (0.0960, 0.0205, 0.0325),
            (0.94, 0.88, 0.62),
            ("bar of soap", "yellow soap", "small bar of soap", "cream coloured soap"),
        ),
        1: partial(
            pebble,
            (0.0960, 0.0210, 0.0480),
            (0.95, 0.62, 0.70),
            ("pink soap", "oval soap", "pink bar of soap", "pink soap with letters"),
        ),
        2: partial(
            dished,
            (0.0960, 0.0380, 0.0650),
            (0.60, 0.85, 0.65),
            (0.90, 0.90, 0.92),
            ("green soap on a dish", "soap dish with soap", "green soap", "soap on a white dish"),
        ),
        3: partial(
            wrapped,
            (0.0955, 0.0355, 0.0550),
            (0.93, 0.93, 0.88),
            (0.20, 0.40, 0.78),
            ("wrapped soap", "white soap with a blue band", "thick bar of soap", "packed soap"),
        ),
    }
}
