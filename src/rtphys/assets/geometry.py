"""Solids and outlines to build objects from: lengths in metres, y up as in the official models.

Our own: the vertex order of a library's primitives may change with its version.
"""

from collections.abc import Sequence

import manifold3d
import numpy as np
from numpy.typing import ArrayLike, NDArray

from rtphys.assets.solid import Solid, hull

Array = NDArray[np.float64]
Outline = Sequence[Sequence[float]] | Array  # 2D points


def box(x: float, y: float, z: float) -> Solid:
    """A cuboid of these sizes, centred. Convex."""
    return hull(_corners(x, y, z))


def rounded_box(x: float, y: float, z: float, radius: float, steps: int = 2) -> Solid:
    """A cuboid with rounded edges; `steps` facets per quarter turn (1 is a chamfer). Convex."""
    angles = np.linspace(0, np.pi / 2, steps + 1)
    ball = [
        (np.cos(v) * np.cos(h), np.sin(v), np.cos(v) * np.sin(h)) for v in angles for h in angles
    ]
    inner = _corners(x - 2 * radius, y - 2 * radius, z - 2 * radius)
    signs = np.sign(_corners(1, 1, 1))
    points = [c + radius * s * b for c, s in zip(inner, signs, strict=True) for b in np.array(ball)]
    return hull(np.unique(np.round(points, 9), axis=0))


def extrude(outline: Outline, height: float) -> Solid:
    """A closed outline (N, 2) of (x, z) points extruded from y = 0 to `height`."""
    points = np.asarray(outline, float)
    if _area(points) < 0:
        points = points[::-1]
    shape = manifold3d.Manifold.extrude(manifold3d.CrossSection([points]), height)
    mesh = shape.to_mesh64()
    v = np.asarray(mesh.vert_properties, float)[:, :3]
    # (x, z, height) -> (x, height, z) is a mirroring, so the faces are reversed.
    return Solid(v[:, [0, 2, 1]], np.asarray(mesh.tri_verts).astype(np.int64)[:, ::-1])


def lathe(profile: Outline, sides: int = 24) -> Solid:
    """A profile (N, 2) of (radius, y) points revolved about y.

    A profile that starts and ends on the axis is closed there; any other is a closed loop, which
    gives a ring. Points go upward along the outside.
    """
    points = np.asarray(profile, float)
    on_axis = points[0, 0] == 0 and points[-1, 0] == 0
    angles = 2 * np.pi * np.arange(sides) / sides
    circle = np.stack([np.cos(angles), np.zeros(sides), -np.sin(angles)], axis=1)
    vertices, rings = [], []
    for r, y in points:
        rings.append(np.full(sides, len(vertices)) if r == 0 else len(vertices) + np.arange(sides))
        vertices.extend([np.array([0, y, 0])] if r == 0 else r * circle + [0, y, 0])
    loop = list(zip(rings, rings[1:] + ([] if on_axis else rings[:1]), strict=False))
    faces = [_band(lower, upper, sides) for lower, upper in loop]
    return _outward(np.array(vertices), np.vstack(faces))


def cylinder(radius: float, height: float, sides: int = 24) -> Solid:
    """A prism of `sides` about y, centred. Convex."""
    h = height / 2
    return lathe([(0, -h), (radius, -h), (radius, h), (0, h)], sides)


def cone(bottom: float, top: float, height: float, sides: int = 24) -> Solid:
    """A frustum about y from y = 0 to `height`, radii `bottom` and `top` (0 is a tip). Convex."""
    ends = [(0, 0), (bottom, 0), (top, height), (0, height)]
    return lathe([p for i, p in enumerate(ends) if i in (0, 3) or p[0] > 0], sides)


def ball(radius: float, sides: int = 16) -> Solid:
    """A sphere, centred. Convex."""
    angles = np.linspace(-np.pi / 2, np.pi / 2, sides // 2 + 1)
    profile = np.stack([radius * np.cos(angles), radius * np.sin(angles)], axis=1)
    profile[[0, -1], 0] = 0
    return lathe(profile, sides)


def capsule(radius: float, length: float, sides: int = 12) -> Solid:
    """A cylinder about y of total `length` with round ends, centred. Convex."""
    angles = np.linspace(-np.pi / 2, np.pi / 2, 2 * (sides // 4) + 1)
    half = length / 2 - radius
    rows = [
        (radius * np.cos(a), radius * np.sin(a) + np.copysign(half, a))
        for a in angles
        if abs(a) > 1e-9
    ]
    middle = [(radius, -half), (radius, half)]
    n = len(rows) // 2
    profile = np.array(rows[:n] + middle + rows[n:])
    profile[[0, -1], 0] = 0
    return lathe(profile, sides)


def tube(path: ArrayLike, radius: float, sides: int = 8, closed: bool = False) -> Solid:
    """A round bar along a polyline (N, 3), with mitred corners; `closed` joins the ends."""
    p = np.asarray(path, float)
    ahead = np.roll(p, -1, 0) - p
    behind = p - np.roll(p, 1, 0)
    if not closed:
        ahead[-1], behind[0] = behind[-1], ahead[0]
    ahead /= np.linalg.norm(ahead, axis=1)[:, None]
    behind /= np.linalg.norm(behind, axis=1)[:, None]
    tangent = ahead + behind
    tangent /= np.linalg.norm(tangent, axis=1)[:, None]
    # One side direction, carried along the path, keeps the bar from twisting.
    side = np.cross(tangent[0], [0.3, 0.2, 0.9] if abs(tangent[0][2]) < 0.9 else [0.9, 0.2, 0.3])
    angles = 2 * np.pi * np.arange(sides) / sides
    rings = []
    for i in range(len(p)):
        side = side - tangent[i] * (side @ tangent[i])
        side /= np.linalg.norm(side)
        up = np.cross(tangent[i], side)
        widen = 1 / max(float(tangent[i] @ ahead[i]), 0.5)
        bend = ahead[i] - behind[i]
        ring = radius * (np.cos(angles)[:, None] * side + np.sin(angles)[:, None] * up)
        if np.linalg.norm(bend) > 1e-9:  # a mitre is longer along the bend
            b = bend / np.linalg.norm(bend)
            ring += (widen - 1) * np.outer(ring @ b, b)
        rings.append(p[i] + ring)
    n, order = len(p), np.arange(sides)
    pairs = [(i, (i + 1) % n) for i in range(n if closed else n - 1)]
    faces = [_band(i * sides + order, j * sides + order, sides) for i, j in pairs]
    vertices = np.vstack(rings)
    if not closed:
        vertices = np.vstack([vertices, p[0], p[-1]])
        last = (n - 1) * sides + order
        faces += [_band(np.full(sides, len(vertices) - 2), order, sides)]
        faces += [_band(last, np.full(sides, len(vertices) - 1), sides)]
    return _outward(vertices, np.vstack(faces))


# ---- outlines ------------------------------------------------------------------------------


def circle(radius: float, sides: int = 24) -> Array:
    """Outline (sides, 2) of a regular polygon with a corner on +x."""
    angles = 2 * np.pi * np.arange(sides) / sides
    return radius * np.stack([np.cos(angles), np.sin(angles)], axis=1)


def rectangle(x: float, z: float) -> Array:
    """Outline (4, 2), centred."""
    return np.array([(-x, -z), (x, -z), (x, z), (-x, z)]) / 2


def rounded(outline: Outline, radius: float, steps: int = 3, closed: bool = True) -> Array:
    """The same polyline with its corners replaced by arcs of about `radius`.

    Open ends stay; a corner whose legs are short gets a smaller arc.
    """
    p = np.asarray(outline, float)
    out = []
    for i in range(len(p)):
        if not closed and i in (0, len(p) - 1):
            out.append(p[i])
            continue
        back, ahead = p[i - 1] - p[i], p[(i + 1) % len(p)] - p[i]
        lengths = np.linalg.norm(back), np.linalg.norm(ahead)
        back, ahead = back / lengths[0], ahead / lengths[1]
        half = 0.5 * np.arccos(np.clip(back @ ahead, -1, 1))
        reach = min(radius / max(np.tan(half), 1e-6), 0.49 * min(lengths))
        # A quadratic Bezier about the corner: cheap and close to an arc.
        t = np.linspace(0, 1, steps + 1)[:, None]
        out.extend(p[i] + reach * ((1 - t) ** 2 * back + t**2 * ahead))
    return np.array(out)


def _corners(x: float, y: float, z: float) -> Array:
    return np.array([(i, j, k) for i in (-1, 1) for j in (-1, 1) for k in (-1, 1)]) * (
        np.array([x, y, z]) / 2
    )


def _area(points: Array) -> float:
    x, y = points.T
    return float(np.sum(x * np.roll(y, -1) - np.roll(x, -1) * y) / 2)


def _band(lower: NDArray[np.int64], upper: NDArray[np.int64], sides: int) -> NDArray[np.int64]:
    """Triangles (M, 3) between two rings of vertex indices; one repeated index is a pole."""
    i, j = np.arange(sides), np.roll(np.arange(sides), -1)
    faces = []
    if lower[0] != lower[1]:
        faces.append(np.stack([lower[i], lower[j], upper[j]], axis=1))
    if upper[0] != upper[1]:
        faces.append(np.stack([lower[i], upper[j], upper[i]], axis=1))
    return np.vstack(faces) if faces else np.zeros((0, 3), np.int64)


def _outward(vertices: Array, faces: NDArray[np.int64]) -> Solid:
    solid = Solid(vertices, faces.astype(np.int64))
    return Solid(vertices, solid.faces[:, ::-1]) if solid.volume < 0 else solid
