"""A polyline with its corners rounded by parabolas: smooth, and never far from the polyline.

A corner C between unit directions u and v is replaced by the parabola from C - t u to C + t v, that
is the quadratic Bezier curve with C as its middle control point. It stays inside the triangle of
the three points, so nothing overshoots, and its distance from the polyline is at most
t |v - u| / 4 <= t / 2, where t <= CORNER and t <= half of either segment. For the nearly straight
polylines of `ArmKinematics.line` t is half a segment everywhere: a quadratic B-spline, off the
polyline by an eighth of its second difference, which is under 0.1 mm at 1 cm spacing.
"""

from dataclasses import dataclass

import numpy as np

from rtphys.core.poses import Array

CORNER = 0.1  # [rad, joint-space 2-norm] of a segment given to a corner; deviation <= half of it
SAME_POINT = 1e-9  # [rad]


@dataclass(frozen=True, eq=False)
class BlendedPath:
    """Piecewise quadratic curve q(s) over joint-space length s, continuous with its slope.

    On piece k, with r = s - breaks[k]: q = start[k] + slope[k] r + bend[k] r^2 / 2.
    """

    breaks: Array  # (m + 1,) from 0 to the length
    start: Array  # (m, d)
    slope: Array  # (m, d)
    bend: Array  # (m, d)

    @classmethod
    def through(cls, waypoints: Array, corner: float = CORNER) -> "BlendedPath | None":
        """Round the corners of a polyline (n, d); None when it has no length."""
        points = distinct(waypoints)
        if len(points) < 2:
            return None
        edges = np.diff(points, axis=0)
        lengths = np.linalg.norm(edges, axis=1)
        directions = edges / lengths[:, None]
        cut = np.zeros(len(points))  # t at each point
        cut[1:-1] = np.minimum(corner, np.minimum(lengths[:-1], lengths[1:]) / 2)

        # Each edge yields what is left of it straight, then the corner at its end.
        straight, t = lengths - cut[:-1] - cut[1:], cut[1:]
        spans = np.stack([straight, 2 * t], 1).ravel()
        before = points[:-1] + cut[:-1, None] * directions
        start = np.stack([before, points[1:] - t[:, None] * directions], 1)
        bend = np.zeros_like(start)
        bend[:-1, 1] = np.diff(directions, axis=0) / (2 * t[:-1, None])
        slope = np.repeat(directions, 2, axis=0)
        kept = np.stack([straight > SAME_POINT, t > 0], 1).ravel()
        breaks = np.concatenate([[0.0], np.cumsum(spans[kept])])
        start, bend = start.reshape(slope.shape), bend.reshape(slope.shape)
        return cls(breaks, start[kept], slope[kept], bend[kept])

    @property
    def length(self) -> float:
        return float(self.breaks[-1])

    @property
    def straight(self) -> bool:
        """True for a single straight piece."""
        return len(self.start) == 1

    def at(self, s: Array, order: int = 0) -> Array:
        """Value (order 0) or derivative by s (1, 2) at lengths s (k,): (k, d)."""
        s = np.asarray(s, float)
        k = np.searchsorted(self.breaks, s, side="right") - 1
        k = np.minimum(np.maximum(k, 0), len(self.start) - 1)
        r = (s - self.breaks[k])[..., None]
        if order == 0:
            return self.start[k] + r * (self.slope[k] + 0.5 * r * self.bend[k])
        return self.slope[k] + r * self.bend[k] if order == 1 else self.bend[k]

    def samples(self, resolution: float = 0.05) -> Array:
        """Points (k, d) along the curve, at most `resolution` apart, both ends included."""
        n = int(np.ceil(self.length / resolution)) + 1
        return self.at(np.linspace(0, self.length, max(n, 2)))


def distinct(waypoints: Array) -> Array:
    """The polyline (n, d) without points that repeat their predecessor; both ends are kept."""
    points = np.asarray(waypoints, float)
    if (np.abs(np.diff(points, axis=0)).max(axis=1, initial=0.0) > 2 * SAME_POINT).all():
        return points.copy()  # as nearly always
    kept = [points[0]]
    for point in points[1:]:
        if np.linalg.norm(point - kept[-1]) > SAME_POINT:
            kept.append(point)
    if len(kept) > 1:
        kept[-1] = points[-1]
    return np.array(kept)
