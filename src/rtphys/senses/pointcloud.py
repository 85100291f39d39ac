"""Point clouds from depth pictures, as RoboTwin makes them for DP3: cropped, sampled, coloured.

Every sum is written out number by number, so that the same picture gives the same bits everywhere.
"""

import numpy as np
from numpy.typing import NDArray

from rtphys.senses.sense import Array, Arrays, Field, Pixels, Sense

Floats = NDArray[np.floating]

# [m] What stays, in the task frame: all that is above the table, whose top is at 0.74 (RoboTwin).
LOWEST, HIGHEST = (-0.6, -0.35, 0.7401), (0.6, 0.35, 2.0)


CLOUD_POINTS = 1024  # (RoboTwin, pcd_down_sample_num)


class PointCloud(Sense):
    """What the head camera sees above the table, as points in the world."""

    name = "pointcloud"
    scope = "head"
    size = CLOUD_POINTS * 6 * 4
    fields = (
        Field("cloud", ("pointcloud", "pointclouds"), np.float32, (CLOUD_POINTS, 6), packed=False),
    )

    def capture(self, source: Pixels) -> Arrays:
        return {"cloud": cloud(source, CLOUD_POINTS)}

    def problem(self, frames: Array) -> str:
        colours = frames[..., 3:]
        inside = colours.min() >= 0 and colours.max() <= 1
        return "" if inside else "holds a colour outside 0..1"


def world_points(seen: Pixels) -> NDArray[np.float64]:
    """(H, W, 3) [m] world frame: where the ray through each pixel's centre met something."""
    K, X = np.asarray(seen.intrinsic_cv, float), np.asarray(seen.cam2world_gl, float)
    depth = np.asarray(seen.depth(), float)
    height, width = depth.shape
    right = (np.arange(width) + 0.5 - K[0, 2]) / K[0, 0] * depth
    up = -(np.arange(height)[:, None] + 0.5 - K[1, 2]) / K[1, 1] * depth
    return _turned(X, (right, up, -depth))


def _turned(X: Floats, point: tuple[Floats, Floats, Floats]) -> NDArray[np.float64]:
    """A rigid transform of points given by coordinates (any shape), stacked on a last axis."""
    x, y, z = point
    rows = [X[i, 0] * x + X[i, 1] * y + X[i, 2] * z + X[i, 3] for i in range(3)]
    return np.stack(rows, axis=-1)


def cloud(seen: Pixels, count: int) -> NDArray[np.float32]:
    """(count, 6) of x y z [m] in the world and r g b 0..1; zeros where there are too few points.

    Each point is the farthest from those before it; the first is the uppermost in the picture. The
    crop box stands on the table.
    """
    points = world_points(seen)
    at_task = _turned(seen.X_TW, (points[..., 0], points[..., 1], points[..., 2]))
    inside = (seen.depth() > 0) & ((at_task >= LOWEST) & (at_task <= HIGHEST)).all(axis=-1)
    kept = np.concatenate([points[inside], seen.rgb[inside] / 255], axis=1).astype(np.float32)
    chosen = kept[farthest(kept[:, :3], count)]
    found = np.zeros((count, 6), np.float32)
    found[: len(chosen)] = chosen
    return found


def farthest(points: NDArray[np.float32], count: int) -> NDArray[np.intp]:
    """Indices of points (n, 3), each the farthest from those before it, beginning with the first.

    All n if they are no more than `count`.
    """
    if len(points) <= count:
        return np.arange(len(points))
    axes = [np.ascontiguousarray(points[:, i]) for i in range(3)]
    nearest = np.full(len(points), np.inf, np.float32)
    far, part = np.empty_like(nearest), np.empty_like(nearest)
    chosen = np.zeros(count, np.intp)
    for n in range(1, count):
        last = chosen[n - 1]
        for i, axis in enumerate(axes):
            into = part if i else far
            np.subtract(axis, axis[last], out=into)
            np.multiply(into, into, out=into)
            if i:
                np.add(far, part, out=far)
        np.minimum(nearest, far, out=nearest)
        chosen[n] = nearest.argmax()
    return chosen
