"""The toy blocks of the stacking and ranking tasks, scattered in front of the robot."""

import itertools
from collections.abc import Sequence
from dataclasses import dataclass

from rtphys.task import (
    Box,
    Draw,
    clear_of,
    off_centre,
    reachable,
)

MIDDLE = (0.0, -0.1)  # [m] where such tasks build, kept free at the start
APART = 0.1  # [m] between the centres of two blocks


@dataclass(frozen=True)
class Block:
    """One cube to be scattered."""

    name: str
    half: float  # [m]
    colour: tuple[float, float, float]


def scattered(draw: Draw, blocks: Sequence[Block], clear: float) -> list[Box]:
    """Cubes anywhere in front, each clearly on one side, none in anybody's way.

    Spawn ranges: RoboTwin fact sheet, 2.3, 2.4, 2.45, 2.46.

    Args:
        clear: least distance [m] from MIDDLE.

    Raises:
        Infeasible: "layout".
    """
    taken = [(MIDDLE, clear)]
    boxes = []
    for block in blocks:
        free = clear_of(*taken)
        spot = draw.spot(
            block.name,
            x=(-0.28, 0.28),
            y=(-0.08, 0.05),
            yaw=(-0.75, 0.75),
            where=lambda s, free=free: off_centre(0.05)(s) and reachable(s) and free(s),
        )
        taken.append(((spot.x, spot.y), APART))
        h, phrase = block.half, f"{block.name} block"
        boxes.append(
            Box(
                name=block.name,
                half_size=(h, h, h),
                colour=block.colour,
                pose=spot.pose(),
                phrase=phrase,
            )
        )
    return boxes


def ranked(boxes: Sequence[Box]) -> bool:
    """Whether the boxes nearly form a row from left to right: little would be left to do."""
    gaps = [b.pose.p - a.pose.p for a, b in itertools.pairwise(boxes)]
    return all(0 < gap[0] < 0.13 and abs(gap[1]) < 0.04 for gap in gaps)
