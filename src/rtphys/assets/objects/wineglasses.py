"""088_wineglass: stemmed glasses, some with wine in them. Clutter."""

from functools import partial

from rtphys.assets.asset_model import AssetModel, Body, Part
from rtphys.assets.geometry import cone, cylinder, lathe
from rtphys.assets.material import Colour, plastic
from rtphys.assets.objects import Models
from rtphys.assets.vessel import Vessel
from rtphys.assets.words import Words, phrases

GLASS = plastic((0.78, 0.85, 0.88), 0.9)


def wineglass(
    bowl: Vessel, stem: float, foot: float, wine: Colour | None, words: Words
) -> AssetModel:
    """A bowl on a stem of this length [m] on a foot of this radius."""
    base = cone(foot, 0.25 * foot, 0.006, 20)
    rod = cylinder(0.0045, stem, 8).at(y=0.004 + 0.5 * stem)
    lift = 0.002 + stem
    parts = [p.at(y=lift) for p in bowl.parts()]
    looks = [Part(bowl.shell().at(y=lift) + base + rod, GLASS, "glass", 50)]
    if wine is not None:
        top = 0.45 * bowl.outer[-1][1]
        inside = [(r - 0.0005, y) for r, y in bowl.inner if y < top]
        edge = bowl.radius(top) - bowl.wall - 0.0005
        drink = lathe([(0, bowl.floor), *inside, (edge, top), (0, top)], bowl.sides)
        looks.append(Part(drink.at(y=lift), plastic(wine, 0.8), "food"))
    return AssetModel(
        body=Body(tuple(looks), (base, rod, *parts), 0.16),
        material="glass",
        description=phrases(*words, "stemmed glass"),
        categories=("wineglass", "tableware"),
    )


def _bowl(*outer: tuple[float, float]) -> Vessel:
    return Vessel(outer, 0.003, 0.006, 20, 8)


MODELS: Models = {
    "088_wineglass": {
        0: partial(
            wineglass,
            _bowl((0.012, 0.0), (0.038, 0.026), (0.042, 0.050), (0.034, 0.095)),
            0.085, 0.036, (0.45, 0.05, 0.12), ("red wine glass", "round", "red wine"),
        ),
        1: partial(
            wineglass,
            _bowl((0.010, 0.0), (0.028, 0.024), (0.032, 0.045), (0.028, 0.090)),
            0.095, 0.034, (0.93, 0.84, 0.45), ("white wine glass", "slim", "white wine"),
        ),
        2: partial(
            wineglass, _bowl((0.008, 0.0), (0.020, 0.030), (0.026, 0.130)),
            0.080, 0.033, (0.95, 0.80, 0.35), ("champagne flute", "tall", "sparkling wine"),
        ),
        4: partial(
            wineglass, _bowl((0.010, 0.0), (0.040, 0.018), (0.050, 0.045)),
            0.100, 0.036, None, ("cocktail glass", "wide", "a shallow bowl"),
        ),
    }
}  # fmt: skip
