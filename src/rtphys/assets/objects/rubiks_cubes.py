"""073_rubikscube: puzzle cubes; each side is one printed sticker."""

from functools import partial

from rtphys.assets.asset_model import AssetModel, Body, Part, from_above, from_sides
from rtphys.assets.geometry import box, rounded_box
from rtphys.assets.material import Colour, Picture, plastic
from rtphys.assets.objects import Models
from rtphys.assets.pictures import plain, to_picture
from rtphys.core.seeds import stream

WHITE, YELLOW, RED = (0.95, 0.95, 0.95), (0.98, 0.84, 0.08), (0.80, 0.07, 0.10)
ORANGE, GREEN, BLUE = (0.98, 0.45, 0.05), (0.05, 0.60, 0.25), (0.05, 0.25, 0.70)
COLOURS = (WHITE, YELLOW, RED, ORANGE, GREEN, BLUE)
DOT = 6  # pixels a small square, its dark edge included


def cube(edge: float, count: int, mixed: bool, frame: Colour, words: tuple[str, ...]) -> AssetModel:
    """A cube of `edge` metres with `count` squares a side, solved or mixed up."""
    core = rounded_box(edge, edge, edge, 0.003, 1).at(y=edge / 2)
    looks = [Part(core, plastic(frame, 0.5), "plastic")]
    middle, reach, t = edge / 2, 0.94 * edge, 0.0008
    sides = (
        ("y", box(reach, t, reach).at(0, edge - t / 4, 0)),
        ("y", box(reach, t, reach).at(0, t / 4, 0)),
        ("x", box(t, reach, reach).at(edge / 2, middle, 0)),
        ("x", box(t, reach, reach).at(-edge / 2, middle, 0)),
        ("z", box(reach, reach, t).at(0, middle, edge / 2)),
        ("z", box(reach, reach, t).at(0, middle, -edge / 2)),
    )
    for i, (projection, sticker) in enumerate(sides):
        print_ = _squares(i, count, mixed, frame)
        finish = plastic((1, 1, 1), 0.5).with_picture(print_, projection)
        looks.append(Part(sticker, finish, "plastic"))
    return AssetModel(
        body=Body(tuple(looks), (box(edge, edge, edge).at(y=middle),), 430.0 * edge**3),
        material="plastic",
        description=words,
        # From the sides in the official order: from -x, +z, +x, -z.
        contact_points=from_above((0, middle, 0)) + from_sides(0.46 * edge, (270, 0, 90, 180)),
        categories=("rubik's cube", "toy"),
    )


def _squares(side: int, count: int, mixed: bool, frame: Colour) -> Picture:
    rng = stream(0, "assets", "rubikscube", str(count), str(side))
    canvas = plain(frame, count * DOT, count * DOT)
    for r in range(count):
        for c in range(count):
            colour = COLOURS[int(rng.integers(6)) if mixed else side]
            canvas[r * DOT + 1 : (r + 1) * DOT - 1, c * DOT + 1 : (c + 1) * DOT - 1] = colour
    return to_picture(canvas)


MODELS: Models = {
    "073_rubikscube": {
        0: partial(
            cube,
            0.0655,
            3,
            True,
            (0.04, 0.04, 0.05),
            ("rubik's cube", "mixed puzzle cube", "colourful cube", "scrambled rubik's cube"),
        ),
        1: partial(
            cube,
            0.0583,
            3,
            False,
            (0.04, 0.04, 0.05),
            ("solved rubik's cube", "puzzle cube", "magic cube", "rubik's cube in order"),
        ),
        2: partial(
            cube,
            0.0582,
            2,
            True,
            (0.90, 0.90, 0.90),
            ("two by two puzzle cube", "white framed puzzle cube", "pocket cube", "small cube toy"),
        ),
    }
}
