"""Table and wall textures of the builtin pack, and which of them are kept for evaluation."""

from pathlib import Path

from rtphys.assets.patterns import PATTERNS
from rtphys.assets.pictures import to_picture
from rtphys.assets.png import png_bytes
from rtphys.core.errors import UnknownName
from rtphys.core.seeds import stream

EACH = 4  # pictures of each pattern; the last is unseen
HELD_OUT = ("hexagons", "parquet", "patches")  # patterns of which all pictures are unseen


def texture_names() -> tuple[str, ...]:
    """Names of all pictures, `<split>/<pattern>_<number>`, sorted."""
    names = []
    for pattern in PATTERNS:
        for k in range(EACH):
            unseen = pattern in HELD_OUT or k == EACH - 1
            names.append(f"{'unseen' if unseen else 'seen'}/{pattern}_{k}")
    return tuple(sorted(names))


def write_texture(folder: Path, name: str) -> None:
    """Draw one picture to `<folder>/<name>.png`. Raises UnknownName."""
    if name not in texture_names():
        raise UnknownName("texture", name, texture_names())
    stem = name.split("/")[1]
    pattern = stem.rsplit("_", 1)[0]
    picture = to_picture(PATTERNS[pattern](stream(0, "assets", "texture", stem)))
    path = folder / f"{name}.png"
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_bytes(png_bytes(picture))
