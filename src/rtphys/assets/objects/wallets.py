"""159_wallet: folded leather with a few notes showing."""

from functools import partial

from rtphys.assets.asset_model import AssetModel, Body, Part
from rtphys.assets.geometry import box, cylinder, rounded_box
from rtphys.assets.material import Colour, matt, metal, plastic, tint
from rtphys.assets.objects import Models
from rtphys.assets.pictures import plain, speckle, to_picture
from rtphys.assets.solid import hull, together


def wallet(
    size: tuple[float, float, float], leather: Colour, strap: bool, words: tuple[str, ...]
) -> AssetModel:
    """Two halves about a fold at -z; x, y, z [m]."""
    x, y, z = size
    hide = plastic(leather, 0.35).with_picture(speckle((1.0, 1.0, 1.0), words[0], 0.12), "y")
    lower = rounded_box(x, 0.44 * y, z, 0.18 * y, 1).at(y=0.22 * y)
    upper = rounded_box(0.99 * x, 0.44 * y, 0.97 * z, 0.18 * y, 1).at(0, 0.78 * y, -0.015 * z)
    fold = box(0.97 * x, 0.8 * y, 0.10 * z).at(0, 0.5 * y, -0.44 * z)
    bill = plain((0.62, 0.74, 0.58), 48, 24)
    bill[3:-3, 3:-3] = (0.74, 0.82, 0.68)
    bill[8:16, 18:30] = (0.45, 0.60, 0.44)
    notes = box(0.90 * x, 0.10 * y, 0.92 * z).at(0, 0.5 * y, 0.055 * z)
    money = matt((1, 1, 1)).with_picture(to_picture(bill), "y")
    seam = together(
        *(box(0.92 * x, 0.0006, 0.0012).at(0, y, s * 0.43 * z - 0.015 * z) for s in (-1, 1)),
        *(box(0.0012, 0.0006, 0.86 * z).at(s * 0.455 * x, y, -0.015 * z) for s in (-1, 1)),
    )
    looks = [
        Part(lower + upper, hide, "leather"),
        Part(fold, plastic(tint(leather, 0.8), 0.35), "leather"),
        Part(notes, money, "paper"),
        Part(seam, matt(tint(leather, 1.6)), "fabric"),
    ]
    if strap:
        band = box(0.22 * x, y + 0.0012, 0.30 * z).at(0, y / 2, 0.36 * z)
        stud = cylinder(0.005, 0.002, 10).at(0, y + 0.001, 0.40 * z)
        looks += [Part(band, plastic(tint(leather, 0.7), 0.35), "leather"), Part(stud, metal())]
    whole = hull([*lower.vertices, *upper.vertices])
    return AssetModel(
        body=Body(tuple(looks), (whole,), 0.13),
        material="leather",
        description=words,
        categories=("wallet", "household"),
    )


MODELS: Models = {
    "159_wallet": {
        0: partial(
            wallet,
            (0.112, 0.022, 0.092),
            (0.42, 0.24, 0.13),
            False,
            ("brown wallet", "leather wallet", "wallet", "folded wallet"),
        ),
        1: partial(
            wallet,
            (0.120, 0.026, 0.085),
            (0.13, 0.13, 0.14),
            True,
            ("black wallet", "wallet with a strap", "black leather wallet", "purse"),
        ),
        2: partial(
            wallet,
            (0.100, 0.020, 0.080),
            (0.68, 0.16, 0.20),
            True,
            ("red wallet", "red purse", "small red wallet", "red leather wallet"),
        ),
    },
}
