"""Table tops and walls of the builtin pack, drawn from their names whenever they are needed.

A name such as "seen/planks_017" is a kind and a number. It stands for parameters (colours, sizes
in metres, depths of relief) and for the chance of the drawing; both follow from the name alone. A
pack of pictures would hold 2 GB.
"""

import hashlib
import json
from collections.abc import Callable
from functools import lru_cache
from pathlib import Path
from typing import Literal

import numpy as np

from rtphys.assets.material import Picture
from rtphys.assets.surfaces import cloths, stones, tiles, woods
from rtphys.assets.surfaces.canvas import Canvas, Field, Knobs
from rtphys.core.errors import UnknownName
from rtphys.core.seeds import stream

Place = Literal["table", "wall"]
SPLITS = ("seen", "unseen")
NAMES = "surfaces.json"  # in the folder of a pack's textures
Kind = Callable[[Canvas, Knobs], Field]

EACH = 100  # surfaces of each kind
UNSEEN = 20  # the last of them
HELD_OUT = ("parquet", "leather", "hexagons", "stone_wall")  # kinds of which all are unseen

KINDS: dict[Place, tuple[Kind, ...]] = {
    "table": (
        *(woods.board, woods.planks, woods.butcher_block, woods.weathered, woods.parquet),
        *(stones.marble, stones.granite, stones.terrazzo, stones.concrete, stones.slate),
        *(stones.laminate, stones.brushed, tiles.tiles, tiles.mosaic, tiles.checks),
        *(cloths.linen, cloths.gingham, cloths.tartan, cloths.stripes, cloths.leather),
    ),
    "wall": (
        *(woods.panels, woods.weatherboard, stones.concrete, stones.stone_wall),
        *(tiles.tiles, tiles.subway, tiles.bricks, tiles.hexagons),
        *(cloths.plaster, cloths.wallpaper, cloths.banded),
        *(stones.marble, woods.planks, woods.weathered, cloths.linen),
    ),
}
CANVAS: dict[Place, Canvas] = {
    "table": Canvas(1.2, 0.7, 768, 448),
    "wall": Canvas(3.0, 1.5, 768, 384),
}
"""Size of each picture; a wall goes on beside it as in a mirror."""


@lru_cache(maxsize=8)
def surface_names(place: Place, split: str) -> tuple[str, ...]:
    """Names of all surfaces of a place, `<kind>_<number>`, sorted; `split` is seen or unseen."""
    names = []
    for kind in KINDS[place]:
        for number in range(EACH):
            unseen = kind.__name__ in HELD_OUT or number >= EACH - UNSEEN
            if unseen is (split == "unseen"):
                names.append(f"{kind.__name__}_{number:03d}")
    return tuple(sorted(names))


def draw_surface(place: Place, name: str) -> Picture:
    """The picture of a surface (rows, columns, 3), such as "seen/planks_017".

    Raises:
        UnknownName: no such surface.
    """
    return _drawn(place, name)[0]


def parameters(place: Place, name: str) -> dict[str, float]:
    """The parameters that a surface was drawn with; raises `UnknownName`."""
    return _drawn(place, name)[1].values


def write_names(folder: Path) -> None:
    """Write `<folder>/surfaces.json`: all names, and a digest of the code that draws them."""
    code = hashlib.sha256()
    for path in sorted(Path(__file__).parent.glob("*.py")):
        code.update(path.name.encode() + b"\0" + path.read_bytes())
    names = {split: {place: surface_names(place, split) for place in KINDS} for split in SPLITS}
    folder.mkdir(parents=True, exist_ok=True)
    text = json.dumps({"drawn_by": code.hexdigest(), **names}, indent=1)
    (folder / NAMES).write_text(text + "\n")


def _drawn(place: Place, name: str) -> tuple[Picture, Knobs]:
    split, _, stem = name.partition("/")
    known = surface_names(place, split) if split in SPLITS else ()
    if stem not in known:
        raise UnknownName(f"surface of a {place}", name, (f"{split}/{one}" for one in known))
    kind = next(kind for kind in KINDS[place] if kind.__name__ == stem.rpartition("_")[0])
    knobs = Knobs(stream(0, "assets", "surface", place, stem), split == "unseen")
    values = kind(CANVAS[place], knobs)
    return np.round(np.clip(values, 0, 1) * 255).astype(np.uint8), knobs
