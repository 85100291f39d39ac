"""Open turned vessels: what is seen, and the convex parts of wall and floor.

The wall collides as flat sectors, one of which faces each of +-x and +-z, where rims are pinched.
"""

from dataclasses import dataclass

import numpy as np

from rtphys.assets.asset_model import Array, contact
from rtphys.assets.geometry import Outline, lathe
from rtphys.assets.parts import shell_parts
from rtphys.assets.solid import Solid
from rtphys.assets.turned import turned_parts

LINER = 0.0003  # [m] by which an inner surface of another colour stands out of the wall


@dataclass(frozen=True)
class Vessel:
    """Sizes [m]."""

    outer: tuple[tuple[float, float], ...]  # (radius, y) along the outside, foot to rim
    wall: float  # horizontal thickness
    floor: float  # y of the inside's bottom
    sides: int = 24  # seen
    sectors: int = 12  # colliding; a multiple of 4

    @property
    def inner(self) -> tuple[tuple[float, float], ...]:
        """(radius, y) along the inside, floor to rim."""
        start = (self.radius(self.floor) - self.wall, self.floor)
        above = [(r - self.wall, y) for r, y in self.outer if y > self.floor + 0.001]
        return (start, *above)

    @property
    def rim(self) -> tuple[float, float]:
        """Middle of the rim, (radius, y)."""
        r, y = self.outer[-1]
        return r - self.wall / 2, y

    def radius(self, y: float) -> float:
        """Outside at this height."""
        points = np.array(self.outer)
        return float(np.interp(y, points[:, 1], points[:, 0]))

    def shell(self) -> Solid:
        """All of it, hollow."""
        return lathe([(0, 0), *self.outer, *self.inner[::-1], (0, self.floor)], self.sides)

    def liner(self) -> Solid:
        """The inner surface again, to be seen in another colour."""
        skin = [(r - LINER, y) for r, y in self.inner[:-1]]
        top = (self.inner[-1][0] - LINER, self.inner[-1][1] - 0.001)
        skin = [(0, self.floor + LINER), (skin[0][0], self.floor + LINER), *skin[1:], top]
        back = [(r + 0.002, y) for r, y in (top, *self.inner[-2:0:-1])]
        return lathe([*skin, *back, (self.inner[0][0], 0.5 * self.floor), (0, 0.5 * self.floor)][
            ::-1
        ], self.sides)  # fmt: skip

    def parts(self) -> tuple[Solid, ...]:
        """Convex parts: foot and floor, then the wall's sectors."""
        # Corners so far out that a sector's face is as far from the axis as the round wall, on
        # average.
        n = self.sectors
        grow = float(np.sqrt(2 * np.pi / n / np.sin(2 * np.pi / n)))
        edge = (self.radius(self.floor), self.floor)
        low = [*((r, y) for r, y in self.outer if y < self.floor - 1e-6), edge]
        flat = grow * np.cos(np.pi / n)
        foot = turned_parts([(0, 0), *((flat * r, y) for r, y in low), (0, self.floor)], n)
        high = [edge, *((r, y) for r, y in self.outer if y > self.floor + 0.001)]
        walls = shell_parts(
            [(grow * r, y) for r, y in high], [(grow * r, y) for r, y in self.inner], n
        )
        return (*foot, *(w.turned("y", 180 / n) for w in walls))


def pinch(radius: float, height: float) -> tuple[Array, ...]:
    """Contact points on a rim, official order: 0, 1 at +z, 2, 3 at -z, from above, fingers
    closing across the wall."""
    return tuple(
        contact((0, height, z), (0, 1, 0), (x, 0, 0)) for z in (radius, -radius) for x in (1, -1)
    )


def band(outer: Outline, low: float, high: float, sides: int = 24) -> Solid:
    """A painted stripe that follows the outside between two heights."""
    points = np.asarray(outer, float)
    levels = [low, *(y for y in points[:, 1] if low < y < high), high]
    radii = np.interp(levels, points[:, 1], points[:, 0])
    front = [(r + LINER, y) for r, y in zip(radii, levels, strict=True)]
    back = [(r - 0.001, y) for r, y in zip(radii, levels, strict=True)]
    return lathe([*front, *back[::-1]], sides)
