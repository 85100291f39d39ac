"""Textures of tables and walls that repeat without seams: wood, stone, tile, cloth, noise, stripes.

A pattern takes a random generator and returns a picture (SIZE, SIZE, 3) of floats 0..1 whose
colours are random too.
"""

from collections.abc import Callable

import numpy as np
from numpy.random import Generator
from numpy.typing import ArrayLike, NDArray

Array = NDArray[np.float64]
SIZE = 256  # [pixels]
Y, X = np.mgrid[0:SIZE, 0:SIZE] / SIZE  # each 0..1

WOODS = ((0.76, 0.58, 0.38), (0.52, 0.34, 0.20), (0.87, 0.74, 0.54), (0.36, 0.23, 0.15))


# ---- tools ---------------------------------------------------------------------------------


def noise(rng: Generator, cells_x: int, cells_y: int | None = None) -> Array:
    """Smooth periodic noise in -1..1 with `cells_x` by `cells_y` lattice points."""
    rows = cells_x if cells_y is None else cells_y
    lattice = rng.uniform(-1, 1, (rows, cells_x))
    u, v = X * cells_x, Y * rows
    i, j = u.astype(int), v.astype(int)
    s, t = u - i, v - j
    s, t = s * s * (3 - 2 * s), t * t * (3 - 2 * t)
    right, below = (i + 1) % cells_x, (j + 1) % rows
    top = lattice[j, i] * (1 - s) + lattice[j, right] * s
    bottom = lattice[below, i] * (1 - s) + lattice[below, right] * s
    return top * (1 - t) + bottom * t


def clouds(rng: Generator, cells: int = 4, octaves: int = 5) -> Array:
    """Sum of noises, each finer and weaker than the last, about -1..1."""
    layers = [noise(rng, cells * 2**k) / 1.8**k for k in range(octaves)]
    return np.sum(layers, axis=0) / 1.2


def mix(a: ArrayLike, b: ArrayLike, share: Array) -> Array:
    """Colours (3,) or pictures between a (share 0) and b (share 1)."""
    t = np.clip(share, 0, 1)[..., None]
    return (1 - t) * np.asarray(a, float) + t * np.asarray(b, float)


def colour(rng: Generator, light: tuple[float, float] = (0.35, 0.85), vivid: float = 0.45) -> Array:
    """A random colour (3,); `light` bounds its lightness, `vivid` its distance from grey."""
    hue = rng.uniform(0, 1)
    wheel = np.clip(np.abs((hue * 6 + np.array([0, 4, 2])) % 6 - 3) - 1, 0, 1)
    pure = rng.uniform(0.3, 1.0) * vivid
    return rng.uniform(*light) * (1 - pure + pure * wheel)


def points(rng: Generator, count: int) -> tuple[Array, NDArray[np.int64]]:
    """Cells of random points: (distance to second nearest - to nearest point, index of nearest)."""
    seeds = rng.uniform(0, 1, (count, 2))
    first, second = np.full((SIZE, SIZE), 9.0), np.full((SIZE, SIZE), 9.0)
    owner = np.zeros((SIZE, SIZE), np.int64)
    for k, (x, y) in enumerate(seeds):
        du, dv = np.abs(X - x), np.abs(Y - y)
        d = np.hypot(np.minimum(du, 1 - du), np.minimum(dv, 1 - dv))
        nearer = d < first
        second = np.where(nearer, first, np.minimum(second, d))
        owner = np.where(nearer, k, owner)
        first = np.where(nearer, d, first)
    return second - first, owner


def _grain(rng: Generator, wood: ArrayLike, fibres: int = 64) -> Array:
    """Wood along x: long fibres and wavy rings."""
    warp = 0.35 * noise(rng, 3, 4) + 0.08 * noise(rng, 8, 16)
    rings = 0.5 + 0.5 * np.sin(2 * np.pi * (rng.integers(4, 9) * Y + 1.6 * warp))
    streaks = noise(rng, 4, fibres) * 0.6 + noise(rng, 8, 128) * 0.4
    shade = 1 - 0.20 * rings**2 + 0.13 * streaks
    return np.asarray(wood, float) * shade[..., None]


def _wood(rng: Generator) -> Array:
    return np.array(WOODS[int(rng.integers(len(WOODS)))]) * rng.uniform(0.85, 1.15)


# ---- patterns ------------------------------------------------------------------------------


def board(rng: Generator) -> Array:
    """One broad plank."""
    return _grain(rng, _wood(rng))


def planks(rng: Generator) -> Array:
    """Boards side by side, each its own shade, with dark joints and staggered ends."""
    count = int(rng.integers(5, 8))
    picture = _grain(rng, _wood(rng), 128)
    row = np.minimum((Y * count).astype(int), count - 1)
    shades, ends = rng.uniform(0.78, 1.1, (count, 2)), rng.uniform(0, 1, count)
    along = (X + ends[row]) % 1
    picture = picture * shades[row, (along > 0.5).astype(int)][..., None]
    joint = (
        (np.abs((Y * count) % 1 - 0.5) > 0.475) | (np.abs(along - 0.5) < 0.006) | (along < 0.006)
    )
    return np.where(joint[..., None], 0.35 * picture, picture)


def parquet(rng: Generator) -> Array:
    """Squares of four staves, turned against each other."""
    grain = _grain(rng, _wood(rng), 128)
    cells = 4
    odd = ((X * cells).astype(int) + (Y * cells).astype(int)) % 2 == 1
    picture = np.where(odd[..., None], grain, grain.transpose(1, 0, 2) * 0.9)
    across = np.where(odd, Y, X) * cells * 4
    lengthwise = (np.where(odd, X, Y) * cells).astype(int)
    stave = rng.uniform(0.82, 1.08, (16, 8))[across.astype(int), lengthwise]
    joint = np.abs(across % 1 - 0.5) > 0.46
    return picture * np.where(joint, 0.55, stave)[..., None]


def marble(rng: Generator) -> Array:
    """Thin veins in a pale or dark ground."""
    base, vein = colour(rng, (0.75, 0.97), 0.15), colour(rng, (0.25, 0.55), 0.3)
    if rng.uniform() < 0.35:
        base, vein = 0.35 * base, colour(rng, (0.7, 0.9), 0.2)
    flow = clouds(rng, 3, 6)
    lines = np.abs(np.sin(2 * np.pi * (X + Y + 0.55 * flow)))
    fine = np.abs(np.sin(2 * np.pi * (2 * X - Y + 0.8 * clouds(rng, 4, 5))))
    share = np.clip(1 - 7 * lines, 0, 1) * 0.8 + np.clip(1 - 12 * fine, 0, 1) * 0.35
    return mix(base, vein, share + 0.10 * (flow + 1))


def granite(rng: Generator) -> Array:
    """Grains of three colours."""
    base, second, dark = colour(rng, (0.5, 0.8), 0.25), colour(rng, (0.6, 0.9), 0.2), 0.15
    rough = noise(rng, 64) + 0.8 * noise(rng, 128)
    spots = noise(rng, 96) + 0.5 * noise(rng, 128)
    picture = mix(base, second, 0.5 + 2.2 * rough)
    return mix(picture, np.full(3, dark), 4 * (spots - 0.62))


def terrazzo(rng: Generator) -> Array:
    """Chips of stone in a plain ground."""
    gap, owner = points(rng, 150)
    ground = colour(rng, (0.75, 0.93), 0.12)
    palette = np.array([colour(rng, (0.3, 0.9), 0.5) for _ in range(5)])
    chips = palette[owner % 5]
    big = (owner % 3 != 0) & (gap > 0.018 + 0.02 * (owner % 4) / 3)
    return np.where(big[..., None], chips, ground)


def concrete(rng: Generator) -> Array:
    """Cloudy grey with pores."""
    base = colour(rng, (0.45, 0.72), 0.10)
    shade = 1 + 0.16 * clouds(rng, 3, 6) + 0.05 * noise(rng, 128)
    pores = noise(rng, 110) > 0.86
    return base * np.where(pores, 0.6 * shade, shade)[..., None]


def tiles(rng: Generator) -> Array:
    """Square tiles with light joints, each a little different."""
    cells = int(rng.integers(4, 8))
    tile, joint = colour(rng, (0.45, 0.92), 0.5), colour(rng, (0.6, 0.9), 0.08)
    u, v = (X * cells) % 1, (Y * cells) % 1
    row, column = (Y * cells).astype(int), (X * cells).astype(int)
    shade = rng.uniform(0.88, 1.06, (cells, cells))[row, column]
    edge = np.minimum(np.minimum(u, 1 - u), np.minimum(v, 1 - v))
    gloss = shade * (1 + 0.05 * clouds(rng, 8, 3)) * np.where(edge < 0.07, 0.90, 1.0)
    return np.where((edge < 0.03)[..., None], joint, tile * gloss[..., None])


def checks(rng: Generator) -> Array:
    """A chequered floor of two colours."""
    cells = 2 * int(rng.integers(2, 6))
    a, b = colour(rng, (0.75, 0.95), 0.3), colour(rng, (0.15, 0.5), 0.6)
    odd = ((X * cells).astype(int) + (Y * cells).astype(int)) % 2 == 1
    return np.where(odd[..., None], a, b) * (1 + 0.06 * clouds(rng, 6, 4))[..., None]


def bricks(rng: Generator) -> Array:
    """A wall in running bond."""
    rows, columns = 12, 5
    row = (Y * rows).astype(int)
    u = (X * columns + 0.5 * (row % 2)) % columns
    shade = rng.uniform(0.75, 1.12, (rows, columns))[row, u.astype(int)]
    brick = np.array([0.62, 0.30, 0.22]) if rng.uniform() < 0.6 else colour(rng, (0.5, 0.9), 0.2)
    picture = brick * (shade * (1 + 0.12 * noise(rng, 96)))[..., None]
    v = (Y * rows) % 1
    mortar = (np.abs(u % 1 - 0.5) > 0.475) | (np.abs(v - 0.5) > 0.44)
    return np.where(mortar[..., None], colour(rng, (0.6, 0.85), 0.08), picture)


def linen(rng: Generator) -> Array:
    """Plain weave, thread over thread."""
    base, other = colour(rng, (0.4, 0.9), 0.45), rng.uniform(0.8, 1.1)
    threads = 64
    u, v = X * threads, Y * threads
    over = (u.astype(int) + v.astype(int)) % 2 == 0
    across = np.where(over, u % 1, v % 1)
    body = 0.72 + 0.34 * np.sin(np.pi * across)
    slubs = 1 + 0.10 * noise(rng, 8, 64) + 0.10 * noise(rng, 64, 8)
    return base * (body * slubs * np.where(over, 1.0, other))[..., None]


def tartan(rng: Generator) -> Array:
    """Bands of colour that cross."""
    palette = np.array([colour(rng, (0.2, 0.8), 0.8) for _ in range(4)])
    order = rng.integers(0, 4, 16)
    order = np.concatenate([order, order[::-1]])
    index = order[(np.arange(SIZE) * 32 // SIZE)]
    warp, weft = palette[index][None], palette[index][:, None]
    twill = ((X + Y) * SIZE).astype(int) % 4 < 2
    return np.where(twill[..., None], warp, weft)


def stripes(rng: Generator) -> Array:
    """Bands of three colours across or along."""
    palette = np.array([colour(rng, (0.3, 0.95), 0.6) for _ in range(3)])
    widths = rng.integers(1, 5, 6)
    index = np.repeat(np.arange(6) % 3, widths)
    position = (X if rng.uniform() < 0.5 else Y) * int(rng.integers(1, 4)) % 1
    picture = palette[index[(position * len(index)).astype(int)]]
    return picture * (1 + 0.03 * noise(rng, 64))[..., None]


def spots(rng: Generator) -> Array:
    """Round dots in rows, every other row shifted."""
    ground, dot = colour(rng, (0.4, 0.95), 0.5), colour(rng, (0.3, 0.95), 0.7)
    rows = 2 * int(rng.integers(3, 7))
    row = (Y * rows).astype(int)
    u, v = (X * rows / 2 + 0.5 * (row % 2)) % 1, (Y * rows) % 1
    inside = np.hypot(2 * (u - 0.5), v - 0.5) < rng.uniform(0.22, 0.42)
    return np.where(inside[..., None], dot, ground) * (1 + 0.03 * noise(rng, 32))[..., None]


def gradient(rng: Generator) -> Array:
    """From one colour to another and back, at a slant."""
    a, b = colour(rng, (0.3, 0.9), 0.6), colour(rng, (0.3, 0.9), 0.6)
    turns = (int(rng.integers(0, 2)), 1)
    wave = 0.5 - 0.5 * np.cos(2 * np.pi * (turns[0] * X + turns[1] * Y))
    return mix(a, b, wave) * (1 + 0.015 * noise(rng, 128))[..., None]


def brushed(rng: Generator) -> Array:
    """Metal, brushed along x."""
    base = colour(rng, (0.5, 0.8), 0.15)
    shade = 1 + 0.10 * noise(rng, 4, 128) + 0.05 * noise(rng, 16, 128) + 0.12 * noise(rng, 2, 3)
    return base * shade[..., None]


def leather(rng: Generator) -> Array:
    """Small cells with creases between them."""
    gap, owner = points(rng, 420)
    base = colour(rng, (0.2, 0.65), 0.6)
    shade = np.clip(0.62 + 22 * gap, 0.62, 1.0) * (1 + 0.06 * ((owner % 7) / 3 - 1))
    return base * (shade * (1 + 0.08 * clouds(rng, 4, 4)))[..., None]


def hexagons(rng: Generator) -> Array:
    """A honeycomb of two or three shades."""
    palette = np.array([colour(rng, (0.4, 0.95), 0.45) for _ in range(3)])
    columns, rows = 8, 9  # nearly regular, and it repeats
    best, second = np.full((SIZE, SIZE), 9.0), np.full((SIZE, SIZE), 9.0)
    owner = np.zeros((SIZE, SIZE), np.int64)
    u, v = X * columns, Y * rows
    for shift in (0.0, 0.5):
        i, j = np.round(u - shift), np.round((v - 2 * shift) / 2)
        d = np.hypot(u - shift - i, (v - 2 * shift - 2 * j) * 0.866)
        cell = ((i % columns) * 5 + (j % rows) * 3 + 4 * shift).astype(int) % 3
        second = np.where(d < best, best, np.minimum(second, d))
        owner, best = np.where(d < best, cell, owner), np.minimum(best, d)
    joint = second - best < 0.07
    return np.where(joint[..., None], 0.9, palette[owner] * (1 + 0.04 * noise(rng, 24))[..., None])


def patches(rng: Generator) -> Array:
    """Blotches of four colours, as on camouflage cloth."""
    palette = np.array([colour(rng, (0.2, 0.75), 0.5) for _ in range(4)])
    level = clouds(rng, 4, 4)
    index = np.digitize(level, (-0.35, 0.05, 0.40))
    return palette[index] * (1 + 0.05 * noise(rng, 96))[..., None]


Pattern = Callable[[Generator], Array]
PATTERNS: dict[str, Pattern] = {
    p.__name__: p
    for p in (
        *(board, planks, parquet, marble, granite, terrazzo, concrete, tiles, checks, bricks),
        *(linen, tartan, stripes, spots, gradient, brushed, leather, hexagons, patches),
    )
}
