"""006_hamburg: four burgers and two hot dogs. Their contact points are the official ones."""

from dataclasses import dataclass
from functools import partial

import numpy as np

from rtphys.assets.asset_model import Array, AssetModel, Body, Part, from_above, functional
from rtphys.assets.bread import bread, crust
from rtphys.assets.geometry import ball, box, capsule, circle, extrude, lathe, tube
from rtphys.assets.material import Colour, Finish, matt, plastic
from rtphys.assets.objects import Models
from rtphys.assets.solid import Solid, together
from rtphys.assets.words import Words, phrases

BUN, CRUMB, SEED = (0.85, 0.55, 0.24), (0.96, 0.85, 0.62), (0.98, 0.93, 0.78)
PATTY, CHEESE, LETTUCE = (0.30, 0.16, 0.09), (0.98, 0.75, 0.14), (0.42, 0.70, 0.22)
TOMATO, ONION, SAUSAGE = (0.85, 0.16, 0.10), (0.93, 0.90, 0.95), (0.72, 0.24, 0.13)
MUSTARD, KETCHUP, CHAR = (0.98, 0.80, 0.10), (0.75, 0.08, 0.06), (0.18, 0.14, 0.12)
FILLINGS = {"patty": PATTY, "cheese": CHEESE, "lettuce": LETTUCE, "tomato": TOMATO, "onion": ONION}

SEEDS = (
    (0.0, 0.0),
    (0.5, 0.2),
    (-0.4, 0.35),
    (0.1, -0.5),
    (-0.35, -0.35),
    (0.15, 0.55),
    (0.5, -0.35),
)


@dataclass(frozen=True)
class Burger:
    """Sizes [m] and the layers between the buns, bottom to top."""

    radius: float
    height: float
    layers: tuple[str, ...]
    bun: Colour
    mass: float  # [kg]


def burger(size: Burger, grips: tuple[Array, ...], words: Words) -> AssetModel:
    """Two halves of a bun with layers between them."""
    r, h = size.radius, size.height
    low = 0.20 * h  # top of the lower half
    high = 0.60 * h  # foot of the upper half
    bun = matt((1, 1, 1)).with_picture(crust(size.bun, words[0], 0.06), "cylinder")
    bottom = lathe([(0, 0), (0.90 * r, 0), (r, 0.5 * low), (r, low), (0, low)], 20)
    dome = [(1.0, 0.0), (1.0, 0.22), (0.86, 0.60), (0.50, 0.92)]
    top = lathe([(0, high), *((r * a, high + (h - high) * b) for a, b in dome), (0, h)], 20)
    step = (high - low) / len(size.layers)
    fillings = [
        Part(_layer(kind, r, step).at(y=low + i * step), _finish(kind), "food")
        for i, kind in enumerate(size.layers)
    ]
    looks = (Part(together(bottom, top), bun, "bread", 50), *fillings, _seeds(r, high, h))
    stack = lathe(
        [
            (0, 0),
            (0.93 * r, 0),
            (r, 0.12 * h),
            *((r * a, high + (h - high) * b) for a, b in dome),
            (0, h),
        ],
        16,
    )
    return _meal(Body(looks, (stack,), size.mass), grips, words, ("burger", "food"))


def _layer(kind: str, r: float, step: float) -> Solid:
    """One layer, its underside at y = 0."""
    if kind == "cheese":
        return box(1.5 * r, step, 1.5 * r).turned("y", 45).at(y=0.5 * step)
    if kind == "lettuce":
        wave = r * (1.0 + 0.06 * (-1) ** np.arange(20))
        return extrude(circle(1.0, 20) * wave[:, None], step)
    share = 1.01 if kind == "patty" else 0.95
    return lathe([(0, 0), (share * r, 0), (share * r, step), (0, step)], 20)


def _finish(kind: str) -> Finish:
    return plastic(FILLINGS[kind], 0.5) if kind == "tomato" else matt(FILLINGS[kind])


def _seeds(r: float, high: float, h: float) -> Part:
    """Sesame on the dome."""
    grains = []
    for x, z in SEEDS:
        d = np.hypot(x, z)
        y = high + (h - high) * np.interp(d, [0, 0.5, 0.86, 1.0], [1.0, 0.92, 0.60, 0.22])
        grains.append(ball(0.0022, 6).scaled(1.3, 0.6, 0.8).at(r * x, y, r * z))
    return Part(together(*grains), matt(SEED), "food")


def hot_dog(
    size: tuple[float, float, float],
    mass: float,
    sauce: Colour,
    grips: tuple[Array, ...],
    words: Words,
) -> AssetModel:
    """A long bun, a sausage and a wavy line of sauce; sizes [m] across, up, along z."""
    wide, high, length = size
    bun = matt((1, 1, 1)).with_picture(crust(BUN, words[0], 0.06), "cylinder")
    halves = [
        bread(0.46 * wide, 0.86 * high, 0.94 * length, 0.6).at(x=s * 0.27 * wide) for s in (-1, 1)
    ]
    thick = 0.21 * wide
    sausage = capsule(thick, length, 12).turned("x", 90).at(y=0.97 * high - thick)
    z = np.linspace(-0.38 * length, 0.38 * length, 9)
    wave = np.stack([0.45 * thick * (-1.0) ** np.arange(9), np.full(9, 0.975 * high), z], axis=1)
    looks = (
        Part(together(*halves), bun, "bread", 60),
        Part(sausage, plastic(SAUSAGE, 0.6), "food", 60),
        Part(tube(wave, 0.0018, 5), plastic(sauce, 0.6), "food", 60),
    )
    return _meal(Body(looks, (*halves, sausage), mass), grips, words, ("hot dog", "food"))


def _meal(
    body: Body, grips: tuple[Array, ...], words: Words, categories: tuple[str, ...]
) -> AssetModel:
    return AssetModel(
        body=body,
        material="food",
        description=phrases(*words, "sandwich"),
        contact_points=grips,
        functional_points=(functional((0, 0, 0), (0, -1, 0), (1, 0, 0)),),
        categories=categories,
    )


FOUR = from_above((-0.0025, 0.0129, -0.0010), (0, 90, 180, 270))

MODELS: Models = {
    "006_hamburg": {
        0: partial(
            burger, Burger(0.0330, 0.0245, ("patty", "cheese"), BUN, 0.09), FOUR,
            ("slider", "small", "melted cheese"),
        ),
        1: partial(
            burger, Burger(0.0335, 0.0335, ("lettuce", "patty", "cheese"), BUN, 0.12), FOUR,
            ("cheeseburger", "golden", "green lettuce"),
        ),
        2: partial(
            burger,
            Burger(0.0325, 0.0390, ("lettuce", "patty", "cheese", "tomato", "patty"), BUN, 0.15),
            FOUR, ("double burger", "tall", "two patties"),
        ),
        3: partial(
            hot_dog, (0.0515, 0.0315, 0.0955), 0.11, MUSTARD,
            (
                *from_above((0.0007, 0.0220, 0.0048), (90,)),
                *from_above((0.0004, 0.0203, 0.0034), (270,)),
            ),
            ("hot dog", "long", "yellow mustard"),
        ),
        4: partial(
            burger, Burger(0.0325, 0.0305, ("patty", "onion", "tomato"), CHAR, 0.11),
            (
                *from_above((0.0005, 0.0154, 0.0034), (90, )),
                *from_above((0.0003, 0.0142, 0.0024), (270,)),
                *from_above((0.0005, 0.0154, 0.0034), (180, 270, 0)),
            ),
            ("black burger", "dark", "red tomato"),
        ),
        5: partial(
            hot_dog, (0.0475, 0.0255, 0.0765), 0.07, KETCHUP,
            (
                *from_above((0.0006, 0.0176, 0.0038), (90,)),
                *from_above((0.0003, 0.0162, 0.0027), (270,)),
                *from_above((0.0006, 0.0176, 0.0038), (270,)),
            ),
            ("small hot dog", "short", "red ketchup"),
        ),
    }
}  # fmt: skip
