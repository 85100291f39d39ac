"""055_small-speaker: a cube, a flat round one and an upright box, their grille to +z or up."""

from functools import partial

from rtphys.assets.asset_model import AssetModel, Body, Part
from rtphys.assets.geometry import box, cylinder, extrude, rounded_box
from rtphys.assets.material import Colour, Finish, matt, metal, plastic, tint
from rtphys.assets.objects import Models
from rtphys.assets.pictures import plain, to_picture
from rtphys.assets.solid import Solid
from rtphys.assets.swept import oval


def cube(edge: float, colour: Colour, words: tuple[str, ...]) -> AssetModel:
    """A rounded cube with one driver."""
    shell = rounded_box(edge, edge, edge, 0.006, 2).at(y=edge / 2)
    ring = cylinder(0.40 * edge, 0.004, 20).turned("x", 90).at(0, edge / 2, edge / 2 - 0.001)
    cone = cylinder(0.33 * edge, 0.004, 20).turned("x", 90).at(0, edge / 2, edge / 2 - 0.0004)
    knob = cylinder(0.005, 0.002, 10).at(0.25 * edge, edge, 0)
    looks = (
        Part(shell, plastic(colour, 0.5), "plastic"),
        Part(ring + knob, metal(), "steel"),
        Part(cone, _mesh((0.25, 0.25, 0.27), "z"), "fabric"),
    )
    return _thing(looks, (shell,), 0.16, words)


def puck(size: tuple[float, float, float], colour: Colour, words: tuple[str, ...]) -> AssetModel:
    """A low oval drum covered with cloth, keys on top."""
    x, y, z = size
    outline = oval(x, z, 0, 24)[:, :2]
    drum = extrude(outline, y)
    lid = extrude(0.90 * outline, 0.003).at(y=y - 0.002)
    foot = extrude(1.005 * outline, 0.006)
    keys = box(0.20 * x, 0.002, 0.05 * z) + box(0.05 * x, 0.002, 0.20 * z)
    looks = (
        Part(drum, _mesh(colour, "cylinder"), "fabric", 50),
        Part(lid, plastic(tint(colour, 0.5), 0.6), "plastic"),
        Part(foot, plastic((0.10, 0.10, 0.11), 0.4), "rubber"),
        Part(keys.at(y=y + 0.0012), plastic((0.95, 0.95, 0.95), 0.6), "plastic"),
    )
    return _thing(looks, (drum,), 0.38, words)


def tower(size: tuple[float, float, float], colour: Colour, words: tuple[str, ...]) -> AssetModel:
    """A wide box with two drivers behind a grille."""
    x, y, z = size
    shell = rounded_box(x, y, z, 0.005, 2).at(y=y / 2)
    grille = box(0.90 * x, 0.84 * y, 0.002).at(0, y / 2, z / 2)
    left, right = (_driver(x, y, z, s) for s in (-1, 1))
    light = box(0.06 * x, 0.004, 0.0015).at(0, 0.14 * y, z / 2 + 0.001)
    looks = (
        Part(shell, plastic(colour, 0.6), "plastic"),
        Part(grille, _mesh((0.30, 0.30, 0.32), "z"), "steel"),
        Part(left + right, matt((0.10, 0.10, 0.11)), "rubber"),
        Part(light, plastic((0.25, 0.80, 1.0), 0.8), "plastic"),
    )
    return _thing(looks, (shell,), 0.21, words)


def _driver(x: float, y: float, z: float, side: int) -> Solid:
    disc = cylinder(0.30 * y, 0.003, 16).turned("x", 90)
    return disc.at(side * 0.23 * x, y / 2, z / 2 + 0.0002)


def _mesh(colour: Colour, projection: str) -> Finish:
    canvas = plain(colour, 48, 24)
    canvas[::3, ::3] = tint(colour, 0.35)
    canvas[1::3, 1::3] = tint(colour, 1.25)
    return matt((1.0, 1.0, 1.0)).with_picture(to_picture(canvas), projection)


def _thing(
    looks: tuple[Part, ...], parts: tuple[Solid, ...], mass: float, words: tuple[str, ...]
) -> AssetModel:
    return AssetModel(
        body=Body(looks, parts, mass),
        material="plastic",
        description=words,
        categories=("speaker", "electronics"),
    )


MODELS: Models = {
    "055_small-speaker": {
        1: partial(
            cube,
            0.0500,
            (0.85, 0.25, 0.20),
            ("small red speaker", "cube speaker", "red speaker", "little speaker"),
        ),
        2: partial(
            puck,
            (0.1000, 0.0700, 0.1000),
            (0.45, 0.50, 0.58),
            ("round speaker", "grey speaker", "smart speaker", "cloth covered speaker"),
        ),
        3: partial(
            tower,
            (0.0820, 0.0505, 0.0415),
            (0.14, 0.16, 0.22),
            ("black speaker", "portable speaker", "box speaker", "speaker with two drivers"),
        ),
    },
}
