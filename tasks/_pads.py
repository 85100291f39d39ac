"""A thin coloured pad on the table: where something is to be put."""

from collections.abc import Sequence

from rtphys.task import (
    COLOURS,
    Box,
    Draw,
    Spot,
)


def coloured_pad(
    draw: Draw,
    spot: Spot,
    half_size: tuple[float, float, float],
    colours: Sequence[str] = tuple(COLOURS),
) -> Box:
    """A fixed pad named "pad", of a colour that is drawn.

    Args:
        spot: where its middle is.
        half_size: half its extents [m].
        colours: names in `COLOURS` to draw from.
    """
    colour = draw.choice("colour", *colours)
    return Box(
        name="pad",
        half_size=half_size,
        colour=COLOURS[colour],
        pose=spot.pose(),
        fixed=True,
        phrase=f"{colour} pad",
    )
