"""Open lathe-turned vessels such as cups and bowls, with convex parts of wall and floor.

The wall collides as flat sectors. One faces each of +-x and +-z, where grippers pinch the rim.
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
    """Sizes of a vessel [m]."""

    outer: tuple[tuple[float, float], ...]  # (radius, y) along the outside, foot to rim
    wall: float  # horizontal thickness
    floor: float  # y of the inside's bottom
    sides: int = 24  # of the visual
    sectors: int = 12  # of the collision shape; a multiple of 4

    @property
    def inner(self) -> tuple[tuple[float, float], ...]:
        """Points (radius, y) along the inside, from floor to rim."""
        start = (self.radius(self.floor) - self.wall, self.floor)
        above = [(r - self.wall, y) for r, y in self.outer if y > self.floor + 0.001]
        return (start, *above)

    @property
    def rim(self) -> tuple[float, float]:
        """Middle of the rim (radius, y)."""
        r, y = self.outer[-1]
        return r - self.wall / 2, y

    def radius(self, y: float) -> float:
        """Outer radius [m] at height `y`."""
        points = np.array(self.outer)
        return float(np.interp(y, points[:, 1], points[:, 0]))

    def shell(self) -> Solid:
        """The whole vessel, hollow."""
        return lathe([(0, 0), *self.outer, *self.inner[::-1], (0, self.floor)], self.sides)

    def liner(self) -> Solid:
        """A skin over the inner surface, for another colour."""
        skin = [(r - LINER, y) for r, y in self.inner[:-1]]
        top = (self.inner[-1][0] - LINER, self.inner[-1][1] - 0.001)
        skin = [(0, self.floor + LINER), (skin[0][0], self.floor + LINER), *skin[1:], top]
        back = [(r + 0.002, y) for r, y in (top, *self.inner[-2:0:-1])]
        under = max(0.5 * self.floor, self.floor - 0.002)  # within the floor, not below a foot
        return lathe([*skin, *back, (self.inner[0][0], under), (0, under)][
            ::-1
        ], self.sides)  # fmt: skip

    def parts(self) -> tuple[Solid, ...]:
        """Convex parts: foot and floor, then the wall's sectors."""
        # The corners lie so far out that a sector's flat face is, on average, as far from the axis
        # as the round wall.
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
    """Contact points on a rim, from above, with fingers closing across the wall.

    In the official order: 0 and 1 at +z, 2 and 3 at -z.
    """
    return tuple(
        contact((0, height, z), (0, 1, 0), (x, 0, 0)) for z in (radius, -radius) for x in (1, -1)
    )


def band(outer: Outline, low: float, high: float, sides: int = 24) -> Solid:
    """A painted stripe around the outside between two heights [m]."""
    points = np.asarray(outer, float)
    levels = [low, *(y for y in points[:, 1] if low < y < high), high]
    radii = np.interp(levels, points[:, 1], points[:, 0])
    front = [(r + LINER, y) for r, y in zip(radii, levels, strict=True)]
    back = [(r - 0.001, y) for r, y in zip(radii, levels, strict=True)]
    return lathe([*front, *back[::-1]], sides)
