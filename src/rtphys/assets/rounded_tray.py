"""Rounded trays: open containers such as baskets, boxes, trays and bins with rounded corners."""

from dataclasses import dataclass

import numpy as np

from rtphys.assets.asset_model import Array
from rtphys.assets.geometry import rectangle, rounded
from rtphys.assets.solid import Solid, hull


@dataclass(frozen=True)
class RoundedTray:
    """Sizes [m] of a tray whose outside tapers towards the ground at y = 0."""

    x: float  # at the rim
    y: float  # height
    z: float  # at the rim
    base: float = 0.9  # [1] size at the ground / size at the rim
    wall: float = 0.003
    floor: float = 0.004  # y of the inside's bottom
    corner: float = 0.012  # radius; half of x = z makes it round
    steps: int = 1  # facets per corner, each one a convex part

    def outline(self, y: float, inset: float = 0.0) -> Array:
        """Points (4 (steps + 1), 3) around the tray at a height, counter-clockwise from above."""
        share = self.base + (1 - self.base) * y / self.y
        x, z = share * self.x - 2 * inset, share * self.z - 2 * inset
        flat = rounded(rectangle(x, z), max(share * self.corner - inset, 0.001), self.steps)
        return np.stack([flat[:, 0], np.full(len(flat), y), -flat[:, 1]], axis=1)

    def shell(self) -> Solid:
        """The whole tray, hollow."""
        whole = hull(np.vstack([self.outline(0), self.outline(self.y)]))
        above = self.y + 0.01
        return whole - hull(
            np.vstack([self.outline(self.floor, self.wall), self.outline(above, self.wall)])
        )

    def rim(self, over: float = 0.004, height: float = 0.006) -> Solid:
        """A bead around the upper edge that stands out by `over` [m]."""
        low, high = self.y - height, self.y + 0.0005
        top = self.outline(self.y)
        ring = [_moved(top, y, over) for y in (low, high)]
        inner = [_moved(top, y, -self.wall) for y in (low - 0.01, high + 0.01)]
        return hull(np.vstack(ring)) - hull(np.vstack(inner))

    def rim_parts(self, over: float = 0.004, height: float = 0.006) -> tuple[Solid, ...]:
        """Convex parts of the bead, one per side and corner facet."""
        top = self.outline(self.y)
        rings = [_moved(top, y, by) for by in (over, -self.wall) for y in (self.y - height, self.y)]
        n = len(top)
        sides = [[r[k] for r in rings for k in (i, (i + 1) % n)] for i in range(n)]
        return tuple(hull(np.array(side)) for side in sides)

    def liner(self, depth: float = 0.0012) -> Solid:
        """A plate on the floor, `depth` [m] thick, for a mat or a sheet of paper."""
        low, high = (self.outline(y, self.wall) for y in (self.floor, self.floor + depth))
        return hull(np.vstack([low, high]))

    def parts(self) -> tuple[Solid, ...]:
        """Convex parts: the floor, then one wall per side and corner facet."""
        bottom = hull(np.vstack([self.outline(0), self.outline(self.floor)]))
        low, high = self.outline(self.floor), self.outline(self.y)
        low_in, high_in = (self.outline(y, self.wall) for y in (self.floor, self.y))
        n = len(low)
        walls = [
            hull(np.array([r[k] for r in (low, high, low_in, high_in) for k in (i, (i + 1) % n)]))
            for i in range(n)
        ]
        return (bottom, *walls)


def _moved(outline: Array, y: float, out: float) -> Array:
    """The outline at height `y`, its sides moved outward by `out` [m]."""
    extent = np.abs(outline).max(0)
    factor = np.array([1 + out / extent[0], 1, 1 + out / extent[2]])
    return outline * factor * [1, 0, 1] + [0, y, 0]
