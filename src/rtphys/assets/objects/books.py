"""043_book, 092_notebook and 150_paperback: books that lie on their backs."""

from dataclasses import dataclass
from functools import partial

import numpy as np

from rtphys.assets.asset_model import AssetModel, Body, Part
from rtphys.assets.geometry import box, tube
from rtphys.assets.lettering import write
from rtphys.assets.material import Colour, Picture, matt, metal, plastic, tint
from rtphys.assets.objects import Models
from rtphys.assets.pictures import plain, to_picture
from rtphys.assets.solid import together

PAPER = matt((0.95, 0.93, 0.86))


@dataclass(frozen=True)
class Book:
    """Sizes [m]; the spine is at -x, the head of the page at -z."""

    x: float
    y: float
    z: float
    cover: float  # thickness of a cover
    mass: float


def book(size: Book, colour: Colour, ink: Colour, title: str, words: tuple[str, ...]) -> AssetModel:
    """A bound book: two covers and a spine around a block of pages."""
    x, y, z, t = size.x, size.y, size.z, size.cover
    covers = [box(x, t, z).at(y=v) for v in (t / 2, y - t / 2)]
    spine = box(t, y, z).at(-(x - t) / 2, y / 2, 0)
    pages = box(x - t - 0.004, y - 2 * t, z - 0.006).at(t / 2 - 0.002, y / 2, 0)
    front = box(0.99 * x, 0.0006, 0.99 * z).at(0, y, 0)
    print_ = plastic((1, 1, 1), 0.4).with_picture(_title(colour, ink, title, x / z), "y")
    looks = (
        Part(together(*covers, spine), plastic(colour, 0.3), "cardboard"),
        Part(pages, PAPER, "paper"),
        Part(front, print_, "paper"),
    )
    return _thing(looks, size, words, "book")


def notebook(
    size: Book, colour: Colour, band: Colour, rings: int, words: tuple[str, ...]
) -> AssetModel:
    """A spiral notebook, or without rings one with a band around it."""
    x, y, z, t = size.x, size.y, size.z, size.cover
    covers = [box(x, t, z).at(y=v) for v in (t / 2, y - t / 2)]
    pages = box(x - 0.004, y - 2 * t, z - 0.004).at(y=y / 2)
    label = box(0.44 * x, 0.0006, 0.26 * z).at(0.04 * x, y, -0.12 * z)
    paper = plain((0.96, 0.96, 0.93), 32, 16)
    paper[5::4, 4:28] = (0.45, 0.50, 0.60)
    looks = [
        Part(together(*covers), plastic(colour, 0.3), "cardboard"),
        Part(pages, PAPER, "paper"),
        Part(label, plastic((1, 1, 1), 0.2).with_picture(to_picture(paper), "y"), "paper"),
    ]
    if rings:
        turns = np.linspace(0, 2 * np.pi, 7)[:-1]
        loop = np.stack([0.0062 * np.cos(turns), (0.5 * y + 0.0016) * np.sin(turns), 0 * turns], 1)
        ring = tube(loop, 0.0009, 4, closed=True).at(-x / 2 + 0.0045, y / 2, 0)
        places = np.linspace(-0.44 * z, 0.44 * z, rings)
        wire = together(*(ring.at(z=float(v)) for v in places))
        looks.append(Part(wire, metal((0.75, 0.75, 0.78)), "steel"))
    else:
        strap = box(0.006, y + 0.0012, 1.001 * z).at(0.38 * x, y / 2, 0)
        looks.append(Part(strap, matt(band), "rubber"))
    return _thing(tuple(looks), size, words, "notebook")


def _thing(looks: tuple[Part, ...], size: Book, words: tuple[str, ...], kind: str) -> AssetModel:
    return AssetModel(
        body=Body(looks, (box(size.x, size.y, size.z).at(y=size.y / 2),), size.mass),
        material="cardboard",
        description=words,
        categories=(kind, "office"),
    )


def _title(colour: Colour, ink: Colour, title: str, ratio: float) -> Picture:
    """Picture of a cover: a frame, a title in lines, a round emblem."""
    high = 60
    canvas = plain(colour, max(round(high * ratio), 30), high)
    canvas[2:4, 2:-2], canvas[-4:-2, 2:-2] = ink, ink
    canvas[2:-2, 2:4], canvas[2:-2, -4:-2] = ink, ink
    for i, line in enumerate(title.split()):
        write(canvas, line, 9 + 8 * i, ink)
    y, x = np.mgrid[0:high, 0 : canvas.shape[1]]
    canvas[np.hypot(x - canvas.shape[1] / 2 + 0.5, y - 42) < 8] = ink
    canvas[np.hypot(x - canvas.shape[1] / 2 + 0.5, y - 42) < 5] = tint(colour, 1.3)
    return to_picture(canvas)


RED, GREEN, NAVY = (0.62, 0.12, 0.12), (0.14, 0.38, 0.24), (0.12, 0.20, 0.42)
GOLD, CREAM, ORANGE = (0.88, 0.74, 0.36), (0.94, 0.90, 0.78), (0.90, 0.45, 0.12)
TEAL, PURPLE, BLACK = (0.15, 0.52, 0.52), (0.42, 0.22, 0.52), (0.11, 0.11, 0.12)

MODELS: Models = {
    "043_book": {
        0: partial(
            book,
            Book(0.158, 0.0500, 0.2120, 0.003, 0.68),
            RED,
            GOLD,
            "WORLD ATLAS",
            ("thick red book", "red book", "hardcover book", "big book"),
        ),
    },
    "092_notebook": {
        0: partial(
            notebook,
            Book(0.188, 0.0196, 0.124, 0.002, 0.24),
            TEAL,
            CREAM,
            14,
            ("teal notebook", "spiral notebook", "notebook with rings", "green notebook"),
        ),
        1: partial(
            notebook,
            Book(0.190, 0.0210, 0.127, 0.002, 0.26),
            BLACK,
            ORANGE,
            0,
            ("black notebook", "notebook with an orange band", "black journal", "closed notebook"),
        ),
        2: partial(
            notebook,
            Book(0.188, 0.0196, 0.126, 0.002, 0.24),
            ORANGE,
            CREAM,
            12,
            ("orange notebook", "orange spiral notebook", "ring bound notebook", "writing pad"),
        ),
    },
    "150_paperback": {
        0: partial(
            book,
            Book(0.112, 0.024, 0.178, 0.0012, 0.22),
            NAVY,
            CREAM,
            "SEA SONG",
            ("blue paperback", "small blue book", "paperback book", "dark blue book"),
        ),
        1: partial(
            book,
            Book(0.125, 0.015, 0.190, 0.0012, 0.17),
            CREAM,
            GREEN,
            "BIRD BOOK",
            ("thin book", "cream coloured book", "slim paperback", "book with a green title"),
        ),
        2: partial(
            book,
            Book(0.106, 0.034, 0.168, 0.0015, 0.29),
            PURPLE,
            GOLD,
            "NIGHT TALES",
            ("purple book", "purple novel", "thick paperback", "purple paperback"),
        ),
    },
}
