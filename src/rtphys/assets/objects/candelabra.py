"""135_candelabrum: candles on metal holders. Own category, for clutter.

The branched one is held below its arms.
"""

from dataclasses import dataclass
from functools import partial

from rtphys.assets.asset_model import AssetModel, Body, Part, from_sides
from rtphys.assets.geometry import cylinder, tube
from rtphys.assets.material import Colour, matt, metal
from rtphys.assets.objects import Models
from rtphys.assets.solid import Solid, hull, together
from rtphys.assets.turned import turned, turned_parts
from rtphys.assets.words import Words, phrases


@dataclass(frozen=True)
class Holder:
    """Sizes [m]."""

    foot: float  # radius
    stem: float  # height at which the cup begins
    cup: float  # radius
    candle: float  # radius
    height: float  # with the wick
    grip: float  # height of the contact points on the stem
    arms: float = 0.0  # |x| of two more candles
    mass: float = 0.4  # [kg]


def candlestick(size: Holder, holder: Colour, wax: Colour, words: Words) -> AssetModel:
    """A foot, a stem, a cup with a candle; with arms, two more of each."""
    post = [(0, 0), (size.foot, 0), (size.foot, 0.006), (0.35 * size.foot, 0.014)]
    post += [(0.008, 0.024), (0.008, size.stem), (size.cup, size.stem + 0.010)]
    post += [(size.cup, size.stem + 0.018), (0, size.stem + 0.018)]
    candles, wicks = [_candle(size, 0.0)], [_wick(size.height, 0.0)]
    metalwork: list[Solid] = [turned(post)]
    hulls = [*turned_parts(post)]
    for side in (-1, 1) if size.arms else ():
        x, low = side * size.arms, size.stem - 0.014
        path = [(0, low - 0.02, 0), (0.6 * x, low - 0.03, 0), (x, low - 0.01, 0), (x, low, 0)]
        cup = cylinder(size.cup, 0.012, 16).at(x, low + 0.004)
        metalwork += [tube(path, 0.004, 6), cup]
        hulls += [cup, *(hull(tube(path[i : i + 2], 0.004, 6).vertices) for i in range(3))]
        candles.append(_candle(size, x).at(y=-0.020))
        wicks.append(_wick(size.height - 0.020, x))
    looks = (
        Part(together(*metalwork), metal(holder, 0.3), "steel", 40),
        Part(together(*candles), matt(wax), "soap"),
        Part(together(*wicks), matt((0.12, 0.10, 0.10)), "fabric"),
    )
    return AssetModel(
        body=Body(looks, (*hulls, *candles, *wicks), size.mass),
        material="steel",
        description=phrases(*words, "candle holder"),
        contact_points=from_sides(size.grip, (270, 315, 0, 45, 90, 135, 180, 225)),
        categories=("candlestick", "household"),
    )


def _candle(size: Holder, x: float) -> Solid:
    low, high = size.stem + 0.008, size.height - 0.008
    return cylinder(size.candle, high - low, 12).at(x, 0.5 * (low + high))


def _wick(height: float, x: float) -> Solid:
    return cylinder(0.0015, 0.010, 6).at(x, height - 0.005)


BRASS, SILVER, IRON = (0.84, 0.66, 0.30), (0.76, 0.77, 0.80), (0.16, 0.16, 0.17)
WHITE, RED, CREAM = (0.95, 0.94, 0.90), (0.75, 0.14, 0.14), (0.95, 0.88, 0.72)

MODELS: Models = {
    "135_candelabrum": {
        0: partial(
            candlestick, Holder(0.032, 0.085, 0.016, 0.0105, 0.193, 0.0566), BRASS, WHITE,
            ("candlestick", "brass", "a white candle"),
        ),
        1: partial(
            candlestick,
            Holder(0.034, 0.100, 0.015, 0.0100, 0.192, 0.0380, arms=0.070, mass=0.6),
            SILVER, CREAM, ("candelabrum", "silver", "three candles"),
        ),
        2: partial(
            candlestick, Holder(0.060, 0.078, 0.028, 0.0200, 0.192, 0.0617, mass=0.55), IRON, RED,
            ("candlestick", "black", "a thick red candle"),
        ),
    }
}  # fmt: skip
