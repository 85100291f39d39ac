"""Surfaces of wood: boards, planks, blocks, parquet, panels."""

import numpy as np
from numpy.random import Generator

from rtphys.assets.surfaces.canvas import Canvas, Field, Knobs, per_cell, shaded, step


def _grain(canvas: Canvas, rng: Generator, knobs: dict[str, float]) -> Field:
    """Shade (rows, columns) about 1 of wood whose fibres run along x."""
    rings, depth = knobs["ring"], knobs["depth"]
    wave = canvas.noise(rng, 0.55, 0.05) * 0.9 + canvas.noise(rng, 0.22, 0.03) * 0.35
    phase = (canvas.y + float(rng.uniform(0, 1))) / np.float32(rings) + wave * knobs["wavy"]
    late = phase - np.floor(phase)
    rise = late * late * late * step(0.0, 0.06, 1 - late)  # slowly darker, then suddenly light
    fibres = canvas.noise(rng, 0.09, 0.0016) * 0.6 + canvas.noise(rng, 0.03, 0.003) * 0.4
    pores = step(0.62, 0.2, canvas.noise(rng, 0.012, 0.0016))
    return 1 - depth * rise + 0.07 * fibres - 0.13 * pores + 0.06 * canvas.noise(rng, 0.4, 0.2)


def _wood(knobs: Knobs) -> tuple[Field, dict[str, float]]:
    """Colour (3,) and grain of a species."""
    colour = knobs.colour("wood", (0.045, 0.115), (0.28, 0.68), (0.34, 0.88))
    grain = {
        "ring": knobs.number("ring", 0.006, 0.028),  # [m]
        "depth": knobs.number("depth", 0.12, 0.38),
        "wavy": knobs.number("wavy", 0.5, 1.8),
    }
    return colour, grain


def _darken(picture: Field, joint: Field) -> Field:
    return picture * (1 - 0.72 * joint)[..., None]


def _rows_of_boards(canvas: Canvas, knobs: Knobs, width: float, length: float) -> Field:
    """Boards along x with joints between them, each of its own shade and grain."""
    rng, (colour, grain) = knobs.rng, _wood(knobs)
    spread = knobs.number("spread", 0.04, 0.2)
    gap = knobs.number("gap", 0.0012, 0.004)  # [m]
    picture = np.empty((canvas.rows, canvas.columns, 3), np.float32)
    offset, first, number = float(rng.uniform(0, width)), 0, 0
    while first < canvas.rows:
        edge = (number + 1) * width - offset
        last = min(max(round(edge * canvas.rows / canvas.height), first + 1), canvas.rows)
        part = canvas.strip(first, last)
        shift = float(rng.uniform(0, length))
        along = (part.x + shift) / np.float32(length)
        piece = np.floor(along)
        shade = _grain(part, rng, grain) * per_cell(rng, piece, spread)
        ends = step(1 - gap / length, 0.3 * gap / length, along - piece)
        sides = step(part.height - gap, 0.3 * gap, part.y)
        joint = np.maximum(ends, sides) + np.zeros_like(shade)
        picture[first:last] = _darken(shaded(colour, shade), joint)
        first, number = last, number + 1
    return picture


def board(canvas: Canvas, knobs: Knobs) -> Field:
    """One broad veneer."""
    colour, grain = _wood(knobs)
    return shaded(colour, _grain(canvas, knobs.rng, grain))


def planks(canvas: Canvas, knobs: Knobs) -> Field:
    """Planks side by side with staggered ends."""
    return _rows_of_boards(
        canvas, knobs, knobs.number("width", 0.07, 0.16), knobs.number("length", 0.7, 1.6)
    )


def butcher_block(canvas: Canvas, knobs: Knobs) -> Field:
    """Narrow staves that are glued to a block."""
    return _rows_of_boards(
        canvas, knobs, knobs.number("width", 0.028, 0.05), knobs.number("length", 0.18, 0.5)
    )


def weathered(canvas: Canvas, knobs: Knobs) -> Field:
    """Grey old planks with wide joints and stains."""
    width, length = knobs.number("width", 0.09, 0.18), knobs.number("length", 1.0, 2.4)
    picture = _rows_of_boards(canvas, knobs, width, length)
    grey = picture.mean(axis=2, keepdims=True)
    pale = knobs.number("pale", 0.45, 0.85)
    stain = 1 + knobs.number("stain", 0.05, 0.22) * canvas.clouds(knobs.rng, 0.3, 5)
    return (picture * (1 - pale) + grey * pale * 1.05) * stain[..., None]


def parquet(canvas: Canvas, knobs: Knobs) -> Field:
    """Squares of staves, turned against each other."""
    rng, (colour, grain) = knobs.rng, _wood(knobs)
    side = knobs.number("side", 0.12, 0.24)  # [m] of a square of four staves
    column, row = np.floor(canvas.x / side), np.floor(canvas.y / side)
    odd = (column + row) % 2 == 1
    flat = _grain(canvas, rng, grain)
    upright = np.ascontiguousarray(_grain(canvas.turned(), rng, grain).T)
    across = np.where(odd, canvas.x, canvas.y) * np.float32(4 / side)
    stave = np.floor(across)
    shade = np.where(odd, upright, flat) * per_cell(rng, stave * 31 + column * 7 + row * 13, 0.14)
    joint = step(0.47, 0.02, np.abs(across - stave - 0.5))
    square = [np.abs(a / side - np.floor(a / side) - 0.5) for a in (canvas.x, canvas.y)]
    return _darken(shaded(colour, shade), np.maximum(joint, step(0.49, 0.006, np.maximum(*square))))


def panels(canvas: Canvas, knobs: Knobs) -> Field:
    """Upright boards of a wall."""
    upright = canvas.turned()
    picture = _rows_of_boards(
        upright, knobs, knobs.number("width", 0.09, 0.22), knobs.number("length", 3.2, 6.0)
    )
    return np.ascontiguousarray(picture.transpose(1, 0, 2))


def weatherboard(canvas: Canvas, knobs: Knobs) -> Field:
    """Painted boards that overlap, with a shadow under each."""
    rng, height = knobs.rng, knobs.number("height", 0.09, 0.24)  # [m]
    paint = knobs.colour("paint", (0.0, 1.0), (0.02, 0.4), (0.45, 0.95))
    row = np.floor(canvas.y / height)
    down = canvas.y / np.float32(height) - row
    shade = (1.02 - 0.10 * down) * per_cell(rng, row, 0.03) * (1 - 0.55 * step(0.93, 0.04, down))
    shade = shade * (1 + 0.03 * canvas.noise(rng, 0.4, 0.006) + 0.03 * canvas.clouds(rng, 0.5, 4))
    return shaded(paint, shade)
