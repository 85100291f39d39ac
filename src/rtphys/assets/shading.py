"""Turns solids into surfaces to draw, with normals and texture coordinates."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from rtphys.assets.glb import Surface
from rtphys.assets.material import Finish
from rtphys.assets.solid import Solid

Array = NDArray[np.float64]

# Written numbers are rounded far above the last bit, in which sin and cos differ between
# processors. So the bytes of the files, and the digest, do not depend on the machine.
DECIMALS = 6  # of a length in metres: micrometres


def surface(parts: Sequence[tuple[Solid, float]], finish: Finish) -> Surface:
    """Join parts (solid, crease angle in degrees) of one finish into one drawable surface."""
    corners = [_shaded(solid, crease, finish) for solid, crease in parts]
    rows = np.vstack(corners)  # one row per triangle corner: point, normal, uv
    unique, index = np.unique(rows, axis=0, return_inverse=True)
    faces = index.reshape(-1, 3).astype(np.uint32)
    flat = (
        (faces[:, 0] == faces[:, 1]) | (faces[:, 1] == faces[:, 2]) | (faces[:, 2] == faces[:, 0])
    )
    return Surface(
        points=unique[:, :3].astype(np.float32),
        faces=faces[~flat],
        normals=unique[:, 3:6].astype(np.float32),
        uv=unique[:, 6:8].astype(np.float32) if finish.picture is not None else None,
        finish=finish,
    )


def bare(solid: Solid) -> Surface:
    """A surface of points and faces only, for collision."""
    points = np.round(solid.vertices, DECIMALS) + 0.0
    return Surface(points.astype(np.float32), solid.faces.astype(np.uint32))


def _shaded(solid: Solid, crease_deg: float, finish: Finish) -> Array:
    points = np.round(solid.vertices, DECIMALS) + 0.0  # + 0.0 turns -0 into 0
    triangles = points[solid.faces]
    area = np.cross(triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0])
    length = np.linalg.norm(area, axis=1)
    face = area / np.maximum(length, 1e-15)[:, None]
    normals = _corner_normals(points, solid.faces, area, face, np.cos(np.deg2rad(crease_deg)))
    uv = _project(triangles, face, finish) if finish.picture is not None else np.zeros((0, 2))
    columns = [triangles.reshape(-1, 3), np.round(normals, 3) + 0.0]
    columns += [np.round(uv, 4) + 0.0] if finish.picture is not None else []
    return np.hstack(columns)


def _corner_normals(
    points: Array, faces: NDArray[np.int64], area: Array, face: Array, cosine: float
) -> Array:
    """Normals (3 M, 3): area-weighted means over faces that meet below the crease angle."""
    _, corner = np.unique(points, axis=0, return_inverse=True)
    owner = corner.reshape(-1)[faces].reshape(-1)
    order = np.argsort(owner, kind="stable")
    starts = np.flatnonzero(np.diff(owner[order], prepend=-1))
    result = np.zeros((len(owner), 3))
    for group in np.split(order, starts[1:]):
        f = group // 3
        near = face[f] @ face[f].T >= cosine - 1e-9
        result[group] = near @ area[f]
    lengths = np.linalg.norm(result, axis=1)
    fallback = np.repeat(face, 3, axis=0)
    return np.where(
        lengths[:, None] > 1e-15, result / np.maximum(lengths, 1e-15)[:, None], fallback
    )


def _project(triangles: Array, face: Array, finish: Finish) -> Array:
    """Texture coordinates (3 M, 2), projected over the solid's bounding box."""
    low, high = triangles.min((0, 1)), triangles.max((0, 1))
    t = (triangles - low) / np.maximum(high - low, 1e-9)
    if finish.projection == "cylinder":
        middle = (low + high) / 2
        angle = np.arctan2(-(triangles[..., 2] - middle[2]), triangles[..., 0] - middle[0])
        centre = triangles.mean(1) - middle
        mean = np.arctan2(-centre[:, 2], centre[:, 0])[:, None]
        angle = mean + (angle - mean + np.pi) % (2 * np.pi) - np.pi  # no triangle spans the seam
        return np.stack([angle / (2 * np.pi), 1 - t[..., 1]], axis=-1).reshape(-1, 2)
    u, v = {"x": (2, 1), "y": (0, 2), "z": (0, 1)}[finish.projection]
    across = t[..., u]
    down = t[..., v] if finish.projection == "y" else 1 - t[..., v]
    # Seen from the far side the picture would be mirrored.
    axis = "xyz".index(finish.projection)
    facing = face[:, axis] if finish.projection != "x" else -face[:, axis]
    across = np.where(facing[:, None] < 0, 1 - across, across)
    return np.stack([across, down], axis=-1).reshape(-1, 2)
