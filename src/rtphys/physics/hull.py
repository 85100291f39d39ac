"""Tests whether a centre of mass lies inside a body: in its convex hull, shrunk by a tenth."""

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property

import numpy as np
import scipy  # pyright: ignore[reportMissingTypeStubs]  (its parts wait until they are used)
from numpy.typing import ArrayLike

from rtphys.core.poses import Array
from rtphys.physics.reach import Inside

SHRINK = 0.1  # a real body has a shell, so its centre of mass is never on its surface


@dataclass(frozen=True, eq=False)
class Solid:
    """One dynamic body: collision vertices (n, 3) and nominal centre of mass (3,), body frame."""

    vertices: Array  # [m]
    com: Array  # [m]

    @cached_property
    def _planes(self) -> tuple[Array, Array]:
        """Normals (m, 3) and limits (m,): `normals @ x <= limits` holds inside the shrunk hull."""
        hull = scipy.spatial.ConvexHull(np.asarray(self.vertices, float))
        center = centroid(hull.points[hull.vertices])
        normals, offsets = hull.equations[:, :3], hull.equations[:, 3]
        gap = -(normals @ center + offsets)  # distance of each face from the centroid
        return normals, normals @ center + (1 - SHRINK) * gap

    def holds(self, offset: ArrayLike, scale: float = 1.0) -> bool:
        """Whether com + `offset` [m] lies inside the body when it is `scale` times as large."""
        point = np.asarray(self.com) + np.asarray(offset, float) / scale
        normals, limits = self._planes
        return bool(np.all(normals @ point <= limits))


def centroid(vertices: Array) -> Array:
    """Centre of volume (3,) of the convex hull of points (n, 3)."""
    simplices = np.asarray(vertices)[scipy.spatial.Delaunay(vertices).simplices]  # (m, 4, 3)
    edges = simplices[:, 1:] - simplices[:, :1]
    volumes = np.abs(np.linalg.det(edges))
    return volumes @ simplices.mean(axis=1) / volumes.sum()


def inside(solids: Mapping[str, Solid], scale: float = 1.0) -> Inside:
    """The test that `Domain.sample` takes: whether an offset [m] lies inside every solid it is for.

    The offset is in metres and does not scale; the solids are taken `scale` times as large.
    """
    return lambda offset, reach: all(
        solid.holds(offset, scale) for name, solid in solids.items() if reach.has(name)
    )
