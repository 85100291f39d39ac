"""Pictures of wicker and slatted walls."""

import numpy as np

from rtphys.assets.material import Colour, Picture, tint
from rtphys.assets.pictures import plain, to_picture


def wicker(colour: Colour, rows: int = 8) -> Picture:
    """Wicker: horizontal rods woven over and under vertical ones."""
    canvas = plain(colour, 64, 4 * rows)
    y, x = np.mgrid[: 4 * rows, :64]
    over = (y // 4 + x // 4) % 2 == 0
    canvas[over] = tint(colour, 0.72)
    canvas[y % 4 == 3] = tint(colour, 0.5)
    return to_picture(canvas)


def slats(colour: Colour, gap: Colour, count: int = 16) -> Picture:
    """Vertical bars with dark gaps between them and a closed band above and below."""
    canvas = plain(colour, 64, 32)
    step = 64 // count
    x = np.arange(64)
    canvas[5:27, x % step == 0] = gap
    return to_picture(canvas)
