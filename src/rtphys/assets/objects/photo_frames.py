"""161_photo-frame: pictures that lean back on a strut, facing +z."""

from functools import partial

import numpy as np

from rtphys.assets.asset_model import AssetModel, Body, Part
from rtphys.assets.geometry import box
from rtphys.assets.material import Colour, Finish, Picture, matt, metal, plastic
from rtphys.assets.objects import Models
from rtphys.assets.pictures import to_picture
from rtphys.assets.solid import Solid, hull

LEAN_DEG = 15.0
THICK = 0.010  # [m]
SKIES = {"hills": (0.55, 0.78, 0.95), "sunset": (0.96, 0.62, 0.35), "face": (0.72, 0.80, 0.70)}


def photo_frame(
    size: tuple[float, float], border: float, frame: Finish, scene: str, words: tuple[str, ...]
) -> AssetModel:
    """A frame, the picture in it and a strut behind; width and height of the frame [m]."""
    wide, tall = size
    rim = box(wide, tall, THICK) - box(wide - 2 * border, tall - 2 * border, 3 * THICK)
    back = box(wide - border, tall - border, 0.5 * THICK)
    page = box(wide - 2 * border, tall - 2 * border, 0.001)
    photo = plastic((1, 1, 1), 0.7).with_picture(_scene(scene), "z")
    board = _leaning(box(wide, tall, THICK), tall)
    lift = -board.bounds[0, 1]
    foot_z = -0.62 * tall * np.tan(np.radians(LEAN_DEG)) - 0.30 * tall
    hinge = box(0.16 * wide, 0.10 * tall, 0.003).at(0, 0.12 * tall, -THICK / 2)
    up = _leaning(hinge, tall).at(y=lift)
    sole = box(0.16 * wide, 0.002, 0.004).at(0, 0.001, foot_z)
    strut = hull([*up.vertices, *sole.vertices])
    looks = (
        Part(_leaning(rim, tall).at(y=lift), frame, "wood"),
        Part(_leaning(back, tall).at(y=lift) + strut, matt((0.25, 0.23, 0.21)), "cardboard"),
        Part(_leaning(page.at(z=0.25 * THICK), tall).at(y=lift), photo, "paper"),
    )
    return AssetModel(
        body=Body(looks, (board.at(y=lift), strut), 0.18),
        material="wood",
        description=words,
        categories=("photo frame", "ornament"),
    )


def _leaning(solid: Solid, tall: float) -> Solid:
    """A part modelled upright about its middle, leaned back over the middle of the stand."""
    return solid.turned("x", -LEAN_DEG).at(0, tall / 2, 0)


def _scene(kind: str) -> Picture:
    """Picture of a landscape, a sunset or a portrait in a few areas of colour."""
    y, x = np.mgrid[0:40, 0:48] / 40.0
    canvas = np.broadcast_to(np.array(SKIES[kind]), (40, 48, 3)).copy()
    if kind == "face":
        canvas[(np.hypot((x - 0.6) / 0.62, (y - 1.05) / 0.5) < 1)] = (0.20, 0.30, 0.55)
        canvas[np.hypot(x - 0.6, (y - 0.40) * 0.85) < 0.27] = (0.30, 0.18, 0.10)
        canvas[np.hypot((x - 0.6) * 1.15, (y - 0.48) * 0.9) < 0.22] = (0.92, 0.74, 0.60)
        return to_picture(canvas)
    sun = (0.98, 0.92, 0.55) if kind == "hills" else (0.98, 0.86, 0.40)
    canvas[np.hypot(x - 0.9, y - (0.22 if kind == "hills" else 0.55)) < 0.13] = sun
    far = 0.50 + 0.12 * np.sin(5 * x)
    near = 0.72 + 0.10 * np.sin(7 * x + 2)
    tones = ((0.35, 0.55, 0.45), (0.25, 0.50, 0.22))
    if kind == "sunset":
        far, near, tones = far * 0 + 0.62, near, ((0.25, 0.35, 0.60), (0.20, 0.16, 0.18))
    canvas[y > far], canvas[y > near] = tones
    return to_picture(canvas)


OAK: Finish = matt((0.70, 0.50, 0.30))
BLACK: Colour = (0.10, 0.10, 0.11)

MODELS: Models = {
    "161_photo-frame": {
        0: partial(
            photo_frame,
            (0.150, 0.115),
            0.014,
            OAK,
            "hills",
            ("photo frame", "wooden picture frame", "framed landscape", "picture of hills"),
        ),
        1: partial(
            photo_frame,
            (0.105, 0.140),
            0.012,
            plastic(BLACK, 0.6),
            "face",
            ("black photo frame", "framed portrait", "small picture frame", "portrait photo"),
        ),
        2: partial(
            photo_frame,
            (0.160, 0.120),
            0.010,
            metal((0.84, 0.84, 0.87), 0.3),
            "sunset",
            ("silver photo frame", "picture of a sunset", "silver frame", "metal picture frame"),
        ),
    },
}
