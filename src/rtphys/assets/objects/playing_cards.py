"""081_playingcards: packs of cards that lie flat."""

from functools import partial

import numpy as np

from rtphys.assets.asset_model import AssetModel, Body, Part, contact
from rtphys.assets.geometry import box, rounded_box
from rtphys.assets.material import Colour, Picture, matt, plastic
from rtphys.assets.objects import Models
from rtphys.assets.pictures import to_picture

LENGTH = 0.0966  # [m]
GRIP = 0.0085  # [m] height of the grasps


def cards(
    size: tuple[float, float], along: str, back: Colour, suit: str, words: tuple[str, ...]
) -> AssetModel:
    """A pack: a printed box, `size` is its short side and thickness [m]."""
    width, thick = size
    angle = 0 if along == "z" else 90
    pack = rounded_box(width, thick, LENGTH, 0.0015, 1).at(y=thick / 2)
    face = box(0.95 * width, 0.0005, 0.97 * LENGTH).at(0, thick, 0)
    flap = box(0.5 * width, 0.6 * thick, 0.0006).at(0, thick / 2, LENGTH / 2)
    ink = plastic((1, 1, 1), 0.5).with_picture(_ace(back, suit, along), "y")
    looks = (
        Part(pack.turned("y", angle), plastic(back, 0.4), "cardboard"),
        Part(face.turned("y", angle), ink, "cardboard"),
        Part(flap.turned("y", angle), matt((0.95, 0.95, 0.92)), "cardboard"),
    )
    ahead = np.array([0, 0, 1.0]) if along == "z" else np.array([1.0, 0, 0])
    return AssetModel(
        body=Body(looks, (box(width, thick, LENGTH).at(y=thick / 2).turned("y", angle),), 0.098),
        material="cardboard",
        description=words,
        contact_points=tuple(contact((0, GRIP, 0), (0, 1, 0), s * ahead) for s in (1, -1)),
        categories=("playing cards", "toy"),
    )


def _ace(back: Colour, suit: str, along: str) -> Picture:
    """A white card with one large pip, framed in the colour of the back."""
    y, x = np.mgrid[0:48, 0:32]
    u, v = (x - 15.5) / 9, (y - 23.5) / 11
    if suit == "heart":
        pip = (u**2 + (v + 0.25) ** 2 - 0.55) ** 3 + 1.4 * u**2 * (v + 0.25) ** 3 < 0
    elif suit == "spade":
        leaf = (u**2 + (v - 0.1) ** 2 - 0.5) ** 3 - 1.4 * u**2 * (v - 0.1) ** 3 < 0
        pip = leaf | ((abs(u) < 0.14) & (v > 0.2) & (v < 1.0))
    else:
        pip = abs(u) + abs(v) < 0.95
    canvas = np.full((48, 32, 3), 0.97)
    canvas[:3], canvas[-3:], canvas[:, :2], canvas[:, -2:] = back, back, back, back
    ink = (0.80, 0.05, 0.08) if suit != "spade" else (0.05, 0.05, 0.06)
    canvas[pip] = ink
    for rows, columns in ((slice(5, 10), slice(4, 8)), (slice(38, 43), slice(24, 28))):
        canvas[rows, columns] = ink
    picture = to_picture(canvas)
    return picture if along == "z" else np.ascontiguousarray(np.rot90(picture))


MODELS: Models = {
    "081_playingcards": {
        0: partial(
            cards,
            (0.0602, 0.0212),
            "z",
            (0.75, 0.08, 0.10),
            "heart",
            ("pack of playing cards", "red card pack", "deck of cards", "card pack with a heart"),
        ),
        1: partial(
            cards,
            (0.0668, 0.0200),
            "x",
            (0.08, 0.20, 0.58),
            "spade",
            ("blue pack of cards", "blue card deck", "deck of cards", "card pack with a spade"),
        ),
        2: partial(
            cards,
            (0.0640, 0.0195),
            "x",
            (0.10, 0.42, 0.22),
            "diamond",
            ("green pack of cards", "green card deck", "deck of cards", "diamond card pack"),
        ),
    }
}
