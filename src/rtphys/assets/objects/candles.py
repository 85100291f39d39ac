"""051_candlestick and 158_candle: a holder with a burning-down candle, and pillar candles."""

from functools import partial

import numpy as np

from rtphys.assets.asset_model import AssetModel, Body, Part
from rtphys.assets.geometry import cone, cylinder, lathe, rounded, tube
from rtphys.assets.material import Colour, Finish, metal, plastic, tint
from rtphys.assets.objects import Models
from rtphys.assets.solid import Solid

SIDES = 16


def candlestick(metal_: Finish, wax: Colour, words: tuple[str, ...]) -> AssetModel:
    """A turned holder on a broad foot, a thin candle in it; 19 cm high."""
    base = [(0, 0), (0.032, 0), (0.032, 0.006), (0.012, 0.016)]
    knots = [(0.007, 0.030), (0.013, 0.044), (0.007, 0.058), (0.007, 0.078)]
    profile = [*base, *knots, (0.018, 0.090), (0.018, 0.096), (0, 0.096)]
    holder = lathe(rounded(profile, 0.003, 1, closed=False), SIDES)
    stick = cylinder(0.0095, 0.085, 12).at(y=0.138)
    looks = (
        Part(holder, metal_, "steel", 50),
        Part(stick, plastic(wax, 0.4), "soap"),
        *_flame(0.1805),
    )
    foot = cone(0.032, 0.012, 0.016, SIDES)
    stem = cylinder(0.013, 0.075, 10).at(y=0.0525)
    pan = cylinder(0.018, 0.008, SIDES).at(y=0.092)
    tip = cone(0.003, 0.0005, 0.012, 6).at(y=0.1805)
    return _thing(looks, (foot, stem, pan, stick, tip), 0.26, words)


def pillar(radius: float, height: float, wax: Colour, words: tuple[str, ...]) -> AssetModel:
    """A thick candle on a saucer, with runs of wax."""
    saucer = lathe([(0, 0), (0.72 * radius, 0), (1.25 * radius, 0.008), (1.25 * radius, 0.011),
                    (0.95 * radius, 0.008), (0, 0.008)], 20)  # fmt: skip
    body = cylinder(radius, height, 20).at(y=0.006 + height / 2)
    top = 0.006 + height
    places = ((0.6, 0.4 * height), (2.4, 0.25 * height), (4.6, 0.5 * height))
    out = 0.99 * radius
    runs = [
        cylinder(0.005, long, 6).at(out * np.cos(a), top - long / 2, out * np.sin(a))
        for a, long in places
    ]
    looks = (
        Part(body, plastic(wax, 0.4), "soap", 50),
        Part(runs[0] + runs[1] + runs[2], plastic(tint(wax, 1.1), 0.5), "soap"),
        Part(saucer, plastic((0.88, 0.88, 0.88), 0.7), "ceramic", 50),
        *_flame(top),
    )
    dish = cone(0.72 * radius, 1.25 * radius, 0.011, 20)
    tip = cone(0.003, 0.0005, 0.012, 6).at(y=top)
    return _thing(looks, (dish, body, tip), 900 * np.pi * radius**2 * height, words)


def _flame(y: float) -> tuple[Part, ...]:
    """A glowing red wick: an unlit one would hardly be visible."""
    wick = tube([(0, y - 0.002, 0), (0, y + 0.006, 0), (0.002, y + 0.011, 0)], 0.0012, 5)
    return (Part(wick, plastic((0.25, 0.10, 0.06), 0.2), "fabric"),)


def _thing(
    looks: tuple[Part, ...], parts: tuple[Solid, ...], mass: float, words: tuple[str, ...]
) -> AssetModel:
    return AssetModel(
        body=Body(looks, parts, mass),
        material="soap",
        description=words,
        categories=("candle", "ornament"),
    )


MODELS: Models = {
    "051_candlestick": {
        1: partial(
            candlestick,
            metal((0.86, 0.68, 0.28), 0.3),
            (0.94, 0.92, 0.84),
            ("candlestick", "brass candlestick", "golden candle holder", "candle in a holder"),
        ),
    },
    "158_candle": {
        0: partial(
            pillar,
            0.032,
            0.095,
            (0.75, 0.14, 0.14),
            ("red candle", "thick candle", "pillar candle", "red candle on a saucer"),
        ),
        1: partial(
            pillar,
            0.026,
            0.130,
            (0.94, 0.90, 0.78),
            ("white candle", "tall candle", "cream coloured candle", "white pillar candle"),
        ),
        2: partial(
            pillar,
            0.040,
            0.060,
            (0.35, 0.55, 0.42),
            ("green candle", "short candle", "wide candle", "green candle on a saucer"),
        ),
    },
}
