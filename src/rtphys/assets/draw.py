"""A small software rasteriser for contact sheets, which must work where no renderer does."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

Array = NDArray[np.float64]

LIGHT = np.array([-0.45, -0.6, 1.0]) / np.linalg.norm([-0.45, -0.6, 1.0])


@dataclass(frozen=True, eq=False)
class Triangles:
    """Triangles to draw in a z-up world, all with one colour or one picture."""

    corners: Array  # (N, 3, 3) [m]
    colour: Array  # (3,) sRGB 0..1
    uv: Array | None = None  # (N, 3, 2), v downward
    picture: Array | None = None  # (h, w, 3) 0..1

    def moved(self, X: Array) -> "Triangles":
        """The triangles moved by a homogeneous matrix (4, 4)."""
        corners = self.corners @ X[:3, :3].T + X[:3, 3]
        return Triangles(corners, self.colour, self.uv, self.picture)


@dataclass(frozen=True, eq=False)
class View:
    """An orthographic camera that fits a sphere into a square picture."""

    centre: Array  # (3,)
    radius: float  # [m]
    size: int  # [px]
    azimuth_deg: float = -60.0  # from where it looks
    elevation_deg: float = 35.0

    def axes(self) -> Array:
        """Rows: picture right, picture down, into the picture."""
        a, e = np.deg2rad([self.azimuth_deg, self.elevation_deg])
        back = np.array([np.cos(a) * np.cos(e), np.sin(a) * np.cos(e), np.sin(e)])
        right = np.array([-np.sin(a), np.cos(a), 0.0])
        return np.stack([right, -np.cross(back, right), -back])

    def project(self, points: ArrayLike) -> Array:
        """World points (..., 3) [m] as (column, row, depth) [px, px, m]."""
        p = (np.asarray(points, float) - self.centre) @ self.axes().T
        half = self.size / 2
        p[..., :2] = half + p[..., :2] * (0.96 * half / self.radius)
        return p


def fitting(pieces: Sequence[Triangles], size: int) -> View:
    """The view into which all pieces fit, `size` pixels wide."""
    points = np.vstack([piece.corners.reshape(-1, 3) for piece in pieces])
    centre = (points.min(0) + points.max(0)) / 2
    view = View(centre, 1.0, size)
    across = np.abs((points - centre) @ view.axes()[:2].T).max()
    return View(centre, max(float(across), 1e-3), size)


def draw(pieces: Sequence[Triangles], view: View) -> NDArray[np.uint8]:
    """Render a picture (size, size, 3) on a light background, with simple shading, no shadows."""
    image = np.full((view.size, view.size, 3), 0.93)
    depth = np.full((view.size, view.size), np.inf)
    for piece in pieces:
        _draw_piece(image, depth, piece, view)
    return np.round(np.clip(image, 0, 1) * 255).astype(np.uint8)


def _draw_piece(image: Array, depth: Array, piece: Triangles, view: View) -> None:
    corners = view.project(piece.corners)
    p = piece.corners
    normal = np.cross(p[:, 1] - p[:, 0], p[:, 2] - p[:, 0])
    normal /= np.maximum(np.linalg.norm(normal, axis=1), 1e-15)[:, None]
    shade = 0.45 + 0.55 * np.clip(normal @ LIGHT, 0, 1)
    for i in np.flatnonzero(normal @ view.axes()[2] < 0):
        pixels = _cover(depth, corners[i])
        if pixels is None:
            continue
        window, mask, weights = pixels
        colour = piece.colour
        if piece.uv is not None and piece.picture is not None:
            colour = _sample(piece.picture, weights @ piece.uv[i])
        image[window][mask] = colour * shade[i]


def _cover(
    depth: Array, corner: Array
) -> tuple[tuple[slice, slice], NDArray[np.bool_], Array] | None:
    """Pixels of one triangle that are nearest so far: window, mask, corner weights (K, 3)."""
    low = np.maximum(np.floor(corner[:, :2].min(0)).astype(int), 0)
    high = np.minimum(np.ceil(corner[:, :2].max(0)).astype(int) + 1, len(depth))
    (ax, ay, az), (bx, by, bz), (cx, cy, cz) = corner
    area = (bx - ax) * (cy - ay) - (by - ay) * (cx - ax)
    if (high <= low).any() or abs(area) < 1e-9:
        return None
    u, v = np.meshgrid(np.arange(low[0], high[0]) + 0.5, np.arange(low[1], high[1]) + 0.5)
    b = ((u - ax) * (cy - ay) - (v - ay) * (cx - ax)) / area
    c = ((bx - ax) * (v - ay) - (by - ay) * (u - ax)) / area
    z = az + b * (bz - az) + c * (cz - az)
    window = (slice(low[1], high[1]), slice(low[0], high[0]))
    mask = (b >= -1e-6) & (c >= -1e-6) & (b + c <= 1 + 1e-6) & (z < depth[window])
    depth[window][mask] = z[mask]
    return window, mask, np.stack([1 - b - c, b, c], axis=-1)[mask]


def _sample(picture: Array, uv: Array) -> Array:
    height, width, _ = picture.shape
    column = np.floor(uv[:, 0] % 1 * width).astype(int) % width
    row = np.floor(np.clip(uv[:, 1], 0, 0.9999) * height).astype(int)
    return picture[row, column]
