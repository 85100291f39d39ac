"""131_thermos: insulated flasks of steel. Own category, for clutter."""

from functools import partial

from rtphys.assets.asset_model import AssetModel, Body, Part, from_sides
from rtphys.assets.material import Colour, metal, plastic
from rtphys.assets.objects import Models
from rtphys.assets.turned import disc, ring, turned, turned_parts
from rtphys.assets.words import Words, phrases


def thermos(radius: float, height: float, coat: Colour, lid: Colour, words: Words) -> AssetModel:
    """A cylinder with a steel ring and a cup for a lid."""
    low, cup = 0.70 * height, 0.76 * height
    body = [
        (0, 0),
        (0.96 * radius, 0),
        (radius, 0.004),
        (radius, low),
        (0.86 * radius, cup),
        (0, cup),
    ]
    cap = [(0, cup), (0.88 * radius, cup), (0.80 * radius, height - 0.006)]
    cap += [(0.72 * radius, height), (0, height)]
    looks = (
        Part(turned(body), metal(coat, 0.4), "steel"),
        Part(turned(cap), plastic(lid, 0.4)),
        Part(
            ring(radius + 0.0004, 0.004, 0.016) + disc(0.865 * radius, cup - 0.004, cup + 0.001),
            metal(),
            "steel",
        ),
    )
    return AssetModel(
        body=Body(looks, (*turned_parts(body), *turned_parts(cap)), 0.45),
        material="steel",
        description=phrases(*words, "vacuum flask"),
        contact_points=from_sides(0.45 * height),
        categories=("thermos", "kitchen"),
    )


MODELS: Models = {
    "131_thermos": {
        0: partial(
            thermos, 0.036, 0.235, (0.16, 0.30, 0.52), (0.12, 0.12, 0.13),
            ("thermos", "blue", "a black cup"),
        ),
        1: partial(
            thermos, 0.033, 0.205, (0.72, 0.73, 0.76), (0.75, 0.14, 0.12),
            ("thermos", "silver", "a red cup"),
        ),
        2: partial(
            thermos, 0.040, 0.180, (0.30, 0.42, 0.30), (0.86, 0.80, 0.66),
            ("thermos", "green", "a cream cup"),
        ),
    }
}  # fmt: skip
