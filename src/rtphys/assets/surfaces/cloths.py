"""Surfaces of cloth, leather, paint and paper."""

import numpy as np

from rtphys.assets.surfaces.canvas import Canvas, Field, Knobs, mix, shaded, step


def _weave(canvas: Canvas, knobs: Knobs, thread: float) -> Field:
    """Shade of a plain weave, thread over thread, with thicker and thinner ones."""
    rng = knobs.rng
    i, j = canvas.x / np.float32(thread), canvas.y / np.float32(thread)
    over = (np.floor(i) + np.floor(j)) % 2 == 0
    across = np.where(over, j - np.floor(j), i - np.floor(i))
    body = 1.12 - 1.3 * (across - 0.5) ** 2 - 0.05 * over
    slubs = canvas.noise(rng, 0.15, thread) + canvas.noise(rng, thread, 0.15)
    return (body * (1 + knobs.number("slubs", 0.04, 0.14) * slubs)).astype(np.float32)


def linen(canvas: Canvas, knobs: Knobs) -> Field:
    """A plain tablecloth."""
    base = knobs.colour("base", (0.0, 1.0), (0.03, 0.7), (0.25, 0.95))
    shade = _weave(canvas, knobs, knobs.number("thread", 0.0036, 0.006))
    return shaded(base, shade * (1 + 0.05 * canvas.clouds(knobs.rng, 0.35, 3)))


def gingham(canvas: Canvas, knobs: Knobs) -> Field:
    """White cloth with bands of one colour that cross."""
    band = knobs.number("band", 0.014, 0.05)  # [m]
    white = knobs.colour("white", (0.05, 0.2), (0.0, 0.1), (0.88, 0.97))
    dye = knobs.colour("dye", (0.0, 1.0), (0.35, 0.9), (0.2, 0.8))
    across = (np.floor(canvas.x / band) % 2).astype(np.float32)
    down = (np.floor(canvas.y / band) % 2).astype(np.float32)
    return mix(white, dye, (across + down) / 2) * _weave(canvas, knobs, 0.004)[..., None]


def tartan(canvas: Canvas, knobs: Knobs) -> Field:
    """Bands of four colours that cross."""
    rng, sett = knobs.rng, knobs.number("sett", 0.1, 0.3)  # [m] until it repeats
    palette = np.array(
        [knobs.colour(f"dye{k}", (0.0, 1.0), (0.2, 0.85), (0.12, 0.8)) for k in range(4)]
    )
    edges = np.cumsum(rng.uniform(0.02, 0.2, 9))
    order = rng.integers(0, 4, 10)

    def colours(at: Field) -> Field:
        place = np.abs((at / np.float32(sett)) % 1 - 0.5) * 2 * edges[-1]  # there and back
        return palette[order[np.searchsorted(edges, place)]]

    warp, weft = colours(canvas.x[0])[None], colours(canvas.y[:, 0])[:, None]
    twill = (np.floor((canvas.x + canvas.y) / np.float32(0.0048)) % 2).astype(np.float32)
    picture = mix(warp + 0 * weft, weft + 0 * warp, 0.35 + 0.3 * twill)
    return picture * (1 + 0.04 * canvas.noise(rng, 0.004))[..., None]


def stripes(canvas: Canvas, knobs: Knobs) -> Field:
    """Cloth with bands of three colours along one side."""
    rng, sett = knobs.rng, knobs.number("sett", 0.08, 0.3)  # [m]
    palette = np.array(
        [knobs.colour(f"dye{k}", (0.0, 1.0), (0.05, 0.75), (0.25, 0.95)) for k in range(3)]
    )
    edges = np.cumsum(rng.uniform(0.06, 1.0, 6))
    along = canvas.x if rng.random() < 0.5 else canvas.y
    place = ((along / np.float32(sett)) % 1) * edges[-1]
    band = palette[np.searchsorted(edges, place) % 3]
    return band * _weave(canvas, knobs, 0.004)[..., None]


def leather(canvas: Canvas, knobs: Knobs) -> Field:
    """Pebbled hide with creases."""
    rng, cell = knobs.rng, knobs.number("cell", 0.007, 0.016)  # [m]
    base = knobs.colour("base", (-0.05, 0.12), (0.1, 0.8), (0.16, 0.68))
    ridges = np.minimum(np.abs(canvas.noise(rng, cell)), np.abs(canvas.noise(rng, 0.8 * cell)))
    crease = step(0.0, 0.3, ridges)
    shade = canvas.relief(crease, knobs.number("relief", 0.15, 0.5)) * (0.72 + 0.28 * crease)
    return shaded(base, np.clip(shade, 0.3, 1.6) * (1 + 0.1 * canvas.clouds(rng, 0.3, 4)))


def plaster(canvas: Canvas, knobs: Knobs) -> Field:
    """A painted wall with the marks of a roller or a trowel."""
    rng = knobs.rng
    paint = knobs.colour("paint", (0.0, 1.0), (0.0, 0.5), (0.4, 0.97))
    rough = canvas.clouds(rng, knobs.number("cell", 0.02, 0.16), 4, 0.6)
    shade = canvas.relief(rough, knobs.number("relief", 0.02, 0.22))
    return shaded(paint, shade * (1 + 0.035 * canvas.clouds(rng, 1.0, 3)))


def wallpaper(canvas: Canvas, knobs: Knobs) -> Field:
    """Ornaments in rows on a plain ground."""
    rng, pitch = knobs.rng, knobs.number("pitch", 0.08, 0.32)  # [m]
    ground = knobs.colour("ground", (0.0, 1.0), (0.03, 0.45), (0.4, 0.95))
    figure = knobs.colour("figure", (0.0, 1.0), (0.03, 0.55), (0.3, 0.95))
    column = np.floor(canvas.x / pitch)
    u = (canvas.x / np.float32(pitch) - column - 0.5) * 2
    v = ((canvas.y / np.float32(1.5 * pitch) + 0.5 * (column % 2)) % 1 - 0.5) * 2
    radius, angle = np.hypot(u, v), np.arctan2(np.abs(u), v + 0 * u)
    petals, waves = int(rng.integers(3, 8)), int(rng.integers(1, 4))
    lobes = 0.55 + 0.25 * np.cos(petals * angle) + 0.12 * np.cos((petals + waves) * angle)
    rings = np.cos(radius * np.float32(knobs.number("rings", 6.0, 16.0)))
    share = step(0.0, 0.05, lobes - radius) * step(-0.2, 0.2, rings)
    return mix(ground, figure, share) * (1 + 0.02 * canvas.noise(rng, 0.006))[..., None]


def banded(canvas: Canvas, knobs: Knobs) -> Field:
    """Wallpaper with upright stripes of two widths."""
    rng, pitch = knobs.rng, knobs.number("pitch", 0.06, 0.3)  # [m]
    ground = knobs.colour("ground", (0.0, 1.0), (0.02, 0.45), (0.45, 0.97))
    band = knobs.colour("band", (0.0, 1.0), (0.05, 0.6), (0.3, 0.95))
    share = knobs.number("share", 0.25, 0.7)
    u = (canvas.x / np.float32(pitch)) % 1
    wide = (u < share).astype(np.float32)
    thin = (np.abs(u - (1 + share) / 2) < 0.03).astype(np.float32)
    picture = mix(ground, band, np.maximum(wide, thin) + 0 * canvas.y)
    return (
        picture * (1 + 0.025 * canvas.noise(rng, 0.008) + 0.02 * canvas.noise(rng, 0.6))[..., None]
    )
