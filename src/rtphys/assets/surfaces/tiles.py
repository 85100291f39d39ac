"""Surfaces of tiles and bricks."""

import numpy as np

from rtphys.assets.surfaces.canvas import Canvas, Field, Knobs, mix, per_cell, shaded, step


def _laid(
    canvas: Canvas, knobs: Knobs, size: tuple[float, float], bond: float
) -> tuple[Field, Field, Field, Field]:
    """Rows of rectangles: number of each, distance to its edge [m], and place in it (0..1)."""
    wide, tall = size
    row = np.floor(canvas.y / tall)
    along = canvas.x / np.float32(wide) + bond * (row % 2) + float(knobs.rng.uniform(0, 1))
    column = np.floor(along)
    u, v = along - column, canvas.y / np.float32(tall) - row
    edge = np.minimum((0.5 - np.abs(u - 0.5)) * wide, (0.5 - np.abs(v - 0.5)) * tall)
    return column * 17 + row * 131, edge, u, v


def _glazed(canvas: Canvas, knobs: Knobs, size: tuple[float, float], bond: float) -> Field:
    """Tiles with bevelled edges, each a little different, and joints between them."""
    rng = knobs.rng
    tile = knobs.colour("tile", (0.0, 1.0), (0.02, 0.7), (0.3, 0.97))
    joint = knobs.colour("joint", (0.0, 1.0), (0.0, 0.15), (0.35, 0.9))
    gap, bevel = knobs.number("gap", 0.0012, 0.003), 0.004  # [m] half a joint, and the slope
    cell, edge, u, v = _laid(canvas, knobs, size, bond)
    tone = per_cell(rng, cell, knobs.number("spread", 0.01, 0.12))
    slope = 1 - step(gap, bevel, edge)
    lit = 1 + 0.25 * slope * np.sign((0.5 - u) * size[0] + (0.5 - v) * size[1])
    shade = tone * lit * (1 + 0.03 * canvas.clouds(rng, 0.06, 3)) * (1.03 - 0.06 * v)
    face = step(gap, 0.0012, edge)
    return mix(shaded(joint, 1 + 0.08 * canvas.noise(rng, 0.005)), shaded(tile, shade), face)


def tiles(canvas: Canvas, knobs: Knobs) -> Field:
    """Square tiles."""
    side = knobs.number("side", 0.05, 0.2)  # [m]
    return _glazed(canvas, knobs, (side, side), 0.0)


def subway(canvas: Canvas, knobs: Knobs) -> Field:
    """Long tiles in running bond."""
    tall = knobs.number("tall", 0.06, 0.12)  # [m]
    return _glazed(canvas, knobs, (tall * knobs.number("long", 1.8, 3.2), tall), 0.5)


def mosaic(canvas: Canvas, knobs: Knobs) -> Field:
    """Small tiles of several tones of one colour."""
    rng, side = knobs.rng, knobs.number("side", 0.018, 0.035)  # [m]
    first = knobs.colour("first", (0.0, 1.0), (0.1, 0.7), (0.3, 0.9))
    second = knobs.colour("second", (0.0, 1.0), (0.05, 0.5), (0.4, 0.97))
    joint = knobs.colour("joint", (0.0, 1.0), (0.0, 0.12), (0.5, 0.95))
    cell, edge, _, v = _laid(canvas, knobs, (side, side), 0.0)
    share = (per_cell(rng, cell, 0.5) - 0.5) ** 2
    face = mix(first, second, share) * (per_cell(rng, cell + 9, 0.12) * (1.05 - 0.1 * v))[..., None]
    return mix(joint, face, step(0.0012, 0.0012, edge))


def checks(canvas: Canvas, knobs: Knobs) -> Field:
    """A chequered floor of two stones."""
    rng, side = knobs.rng, knobs.number("side", 0.06, 0.16)  # [m]
    light = knobs.colour("light", (0.0, 1.0), (0.02, 0.25), (0.7, 0.97))
    dark = knobs.colour("dark", (0.0, 1.0), (0.05, 0.65), (0.12, 0.5))
    cell, edge, *_ = _laid(canvas, knobs, (side, side), 0.0)
    odd = (cell % 2).astype(np.float32)  # columns count by 17, rows by 131
    veins = 1 + 0.09 * canvas.clouds(rng, 0.12, 5) + 0.02 * per_cell(rng, cell, 1.0)
    return mix(light, dark, odd) * (veins * (0.8 + 0.2 * step(0.0008, 0.001, edge)))[..., None]


def bricks(canvas: Canvas, knobs: Knobs) -> Field:
    """Fired bricks in running bond with rough faces."""
    rng = knobs.rng
    brick = knobs.colour("brick", (-0.02, 0.09), (0.15, 0.7), (0.42, 0.85))
    mortar = knobs.colour("mortar", (0.04, 0.6), (0.0, 0.16), (0.5, 0.9))
    tall = knobs.number("tall", 0.062, 0.1)  # [m]
    size = (tall * knobs.number("long", 2.6, 3.6), tall)
    cell, edge, *_ = _laid(canvas, knobs, size, 0.5)
    rough = canvas.clouds(rng, 0.05, 5, 0.65)
    face = step(0.005, 0.005, edge + 0.0025 * rough)
    tone = per_cell(rng, cell, knobs.number("spread", 0.06, 0.26))
    shade = canvas.relief(rough + 2.5 * face, knobs.number("relief", 0.08, 0.3)) * tone
    burnt = step(1.2, 0.25, per_cell(rng, cell + 5, 0.35))
    body = shaded(brick, np.clip(shade, 0.4, 1.5)) * (1 - 0.35 * burnt)[..., None]
    return mix(shaded(mortar, 1 + 0.1 * rough), body, face)


def hexagons(canvas: Canvas, knobs: Knobs) -> Field:
    """A honeycomb of tiles of three tones."""
    rng, wide = knobs.rng, knobs.number("wide", 0.05, 0.13)  # [m] between opposite sides
    palette = [knobs.colour(f"tile{k}", (0.0, 1.0), (0.05, 0.6), (0.35, 0.95)) for k in range(3)]
    joint = knobs.colour("joint", (0.0, 1.0), (0.0, 0.12), (0.5, 0.95))
    tall = wide * np.float32(3**0.5)
    grids = []
    for shift in (0.0, 0.5):  # two grids of rectangles whose centres are all centres of hexagons
        i, j = np.round(canvas.x / wide - shift), np.round(canvas.y / tall - shift)
        dx, dy = np.abs(canvas.x - (i + shift) * wide), np.abs(canvas.y - (j + shift) * tall)
        reach = np.maximum(dx, 0.5 * dx + np.float32(3**0.5 / 2) * dy)
        grids.append((reach, i * 57 + j * 131 + (shift > 0) * 1009))
    (a, first), (b, second) = grids
    near, cell = np.minimum(a, b), np.where(a < b, first, second)
    pick = (per_cell(rng, cell, 0.5) - 0.5) * 3
    face = np.array(palette)[np.clip(pick, 0, 2).astype(int)] * per_cell(rng, cell, 0.05)[..., None]
    return mix(face, joint, step(wide * 0.475, wide * 0.012, near))
