"""How deep one convex shape lies in another, by exact distances."""

import coal  # pyright: ignore[reportMissingImports]  (lives behind a .pth file)
import numpy as np

from rtphys.core.poses import Array
from rtphys.plan.robot_shapes import hull


def depth(a: Array, b: Array, least: float) -> float:
    """Depth [m] to which the hulls of points (n, 3) and (m, 3) overlap; 0 below `least`."""
    if np.any(a.min(0) > b.max(0) - least) or np.any(b.min(0) > a.max(0) - least):
        return 0.0
    still, request, result = (
        coal.Transform3s(),
        coal.DistanceRequest(True, True),
        coal.DistanceResult(),
    )
    coal.distance(hull(a), still, hull(b), still, request, result)
    found = -float(result.min_distance)
    return found if found > least else 0.0
