"""Printed labels, which make bottles, cans and packets distinct at a size of 20 pixels."""

import numpy as np
from numpy.typing import NDArray

from rtphys.assets.material import Colour, Picture
from rtphys.assets.pictures import plain, to_picture

WIDE, HIGH = 64, 32  # [px] a label around a bottle shows its badge twice


def label(ground: Colour, accent: Colour, ink: Colour, style: str = "badge") -> Picture:
    """Picture (32, 64, 3) of a label in three colours.

    Styles: "badge" an oval with a name, "band" a broad stripe with a name, "wave" a slanting
    field, "fruit" three round fruits, "blocks" a headline over a list of contents.
    """
    canvas = plain(ground, WIDE, HIGH)
    x, y = np.meshgrid(np.arange(WIDE), np.arange(HIGH))
    here = (x % 32) - 15.5  # each half of the circumference shows the same
    if style == "badge":
        canvas[(here / 12) ** 2 + ((y - 15.5) / 9) ** 2 < 1] = accent
        canvas[13:18][np.abs(here[13:18]) < 8] = ink
    elif style == "band":
        canvas[9:23] = accent
        canvas[13:19][np.abs(here[13:19]) < 10] = ink
    elif style == "wave":
        edge = 16 + 7 * np.sin(2 * np.pi * x / 32)
        canvas[y > edge] = accent
        canvas[8:13][np.abs(here[8:13] + 3) < 8] = ink
    elif style == "fruit":
        for cx, cy in ((-6, 19), (6, 19), (0, 24)):
            canvas[(here - cx) ** 2 + (y - cy) ** 2 < 30] = accent
        canvas[5:11][np.abs(here[5:11]) < 11] = ink
    else:
        canvas[:10] = accent
        canvas[3:7][np.abs(here[3:7]) < 10] = ink
        for row in range(15, 29, 4):
            canvas[row : row + 2][np.abs(here[row : row + 2] + row % 3) < 9] = ink
    canvas[[0, 1, -2, -1]] = _mix(ground, accent)
    return to_picture(canvas)


def _mix(a: Colour, b: Colour) -> NDArray[np.float64]:
    return (np.array(a) + np.array(b)) / 2
