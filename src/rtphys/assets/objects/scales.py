"""072_electronicscale: kitchen scales with a flat platform and a small display."""

from dataclasses import dataclass
from functools import partial

from rtphys.assets.asset_model import AssetModel, Body, Part, functional
from rtphys.assets.geometry import box, cylinder, rounded_box
from rtphys.assets.lettering import write
from rtphys.assets.material import Colour, Finish, Picture, metal, plastic
from rtphys.assets.objects import Models
from rtphys.assets.pictures import plain, to_picture
from rtphys.assets.solid import Solid, together
from rtphys.assets.swept import bevelled

FOOT = 0.003  # [m]


@dataclass(frozen=True)
class Scale:
    """Sizes [m] and mass [kg]. The display lies at +z, or at +x if `beside`."""

    size: tuple[float, float, float]  # x, y, z
    platform: tuple[float, float]  # its x and z, or its diameter twice if `disc`
    middle: tuple[float, float]  # x, z of the platform
    disc: bool
    beside: bool
    mass: float


def scale(
    make: Scale, shell: Colour, plate: Finish, number: str, words: tuple[str, ...]
) -> AssetModel:
    """A scale: housing, platform on a short neck, display with `number`."""
    x, y, z = make.size
    px, pz = make.platform
    mx, mz = make.middle
    thick = 0.006
    shelf = y - thick - 0.002
    body = _housing(make, shelf)
    top = _top(make, thick).at(mx, y - thick / 2, mz)
    neck = box(0.35 * px, 0.006, 0.35 * pz).at(mx, shelf, mz)
    feet = [
        box(0.012, 0.004, 0.012).at(sx * (x / 2 - 0.014), 0.002, sz * (z / 2 - 0.014))
        for sx in (-1, 1)
        for sz in (-1, 1)
    ]
    looks = (
        Part(body, plastic(shell, 0.5), "plastic"),
        Part(top, plate, "glass" if plate.metallic == 0 else "steel"),
        Part(_display(make, shelf), _lit(number), "plastic"),
        Part(together(*feet, neck), plastic((0.08, 0.08, 0.08), 0.1)),
    )
    return AssetModel(
        body=Body(looks, (body, top, neck, *feet), make.mass),
        material="glass" if plate.metallic == 0 else "steel",
        description=words,
        functional_points=(functional((mx, y, mz), (0, 1, 0), (1, 0, 0)),),
        categories=("electronic scale", "kitchen"),
    )


def _housing(make: Scale, shelf: float) -> Solid:
    """Flat, or falling off towards the display where that is a slope. Convex."""
    x, _, z = make.size
    if make.beside or shelf < 0.03:
        return rounded_box(x, shelf - FOOT + 0.001, z, 0.004, 2).at(y=(shelf + FOOT) / 2)
    h = z / 2
    side = [
        (-h, FOOT),
        (h, FOOT),
        (h, 0.014),
        (h - 0.045, shelf),
        (-h + 0.006, shelf),
        (-h, shelf - 0.01),
    ]
    return bevelled(side, x, 0.004)


def _top(make: Scale, thick: float) -> Solid:
    px, pz = make.platform
    if make.disc:
        return cylinder(px / 2, thick, 24)
    return rounded_box(px, thick, pz, 0.0028, 2)


def _display(make: Scale, shelf: float) -> Solid:
    x, _, z = make.size
    if make.beside:
        return box(0.050, 0.001, 0.024).at(x / 2 - 0.033, shelf + 0.0005, -0.030)
    if shelf < 0.03:
        return box(0.5 * x, 0.001, 0.022).at(0, shelf + 0.0005, z / 2 - 0.017)
    slope = (shelf - 0.014) / 0.045
    lean = 57.2958 * slope / (1 + 0.28 * slope * slope)  # arctan, near enough for a window
    middle = (0, (shelf + 0.014) / 2 + 0.0006, z / 2 - 0.0225)
    return box(0.55 * x, 0.001, 0.024).turned("x", lean).at(*middle)


def _lit(number: str) -> Finish:
    canvas = plain((0.55, 0.72, 0.55), 40, 16)
    canvas[:1], canvas[-1:], canvas[:, :1], canvas[:, -1:] = 0.1, 0.1, 0.1, 0.1
    picture: Picture = to_picture(write(canvas, number, 3, (0.05, 0.08, 0.05), 2))
    return plastic((1, 1, 1), 0.6).with_picture(picture, "y")


STEEL = metal((0.80, 0.81, 0.83), 0.3)

MODELS: Models = {
    "072_electronicscale": {
        0: partial(
            scale,
            Scale((0.116, 0.0400, 0.155), (0.112, 0.112), (0.0, -0.0160), False, False, 0.38),
            (0.90, 0.90, 0.88),
            STEEL,
            "0.00",
            ("white kitchen scale", "electronic scale", "steel kitchen scale", "digital scale"),
        ),
        1: partial(
            scale,
            Scale((0.109, 0.0530, 0.153), (0.106, 0.106), (0.0, -0.0190), True, False, 0.44),
            (0.82, 0.20, 0.18),
            plastic((0.93, 0.93, 0.92), 0.6),
            "0.00",
            (
                "red kitchen scale",
                "round scale",
                "red electronic scale",
                "scale with a round plate",
            ),
        ),
        5: partial(
            scale,
            Scale((0.154, 0.0235, 0.130), (0.088, 0.126), (-0.0322, 0.0), False, True, 0.35),
            (0.12, 0.12, 0.13),
            plastic((0.28, 0.30, 0.33), 0.7),
            "0.0",
            ("black flat scale", "pocket scale", "thin electronic scale", "black kitchen scale"),
        ),
        6: partial(
            scale,
            Scale((0.098, 0.0630, 0.153), (0.096, 0.104), (0.0, -0.0240), False, False, 0.50),
            (0.20, 0.50, 0.62),
            STEEL,
            "0.00",
            ("blue kitchen scale", "tall electronic scale", "blue scale", "letter scale"),
        ),
    }
}
