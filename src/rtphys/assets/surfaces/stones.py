"""Surfaces of stone, concrete and metal."""

import numpy as np

from rtphys.assets.surfaces.canvas import Canvas, Field, Knobs, mix, per_cell, shaded, step


def marble(canvas: Canvas, knobs: Knobs) -> Field:
    """Veins of changing width in a cloudy ground."""
    rng, cell = knobs.rng, knobs.number("cell", 0.16, 0.5)
    base = knobs.colour("base", (0.0, 1.0), (0.02, 0.22), (0.25, 0.97))
    vein = knobs.colour("vein", (0.0, 1.0), (0.05, 0.45), (0.2, 0.9))
    flow = canvas.clouds(rng, cell, 6, 0.6)
    width = 0.03 + 0.05 * (1 + canvas.noise(rng, 0.2))
    strong = np.clip(1 - np.abs(flow) / (width * knobs.number("width", 0.5, 1.4)), 0, 1)
    fine = np.clip(1 - np.abs(canvas.clouds(rng, cell / 3, 5, 0.6)) / 0.06, 0, 1)
    share = knobs.number("depth", 0.5, 0.95) * strong + 0.35 * fine * step(-0.2, 0.6, flow)
    ground = shaded(base, 1 + 0.07 * flow + 0.03 * canvas.noise(rng, 0.01))
    return mix(ground, vein, np.clip(share, 0, 1))


def granite(canvas: Canvas, knobs: Knobs) -> Field:
    """Grains of three minerals."""
    rng, grain = knobs.rng, knobs.number("grain", 0.004, 0.011)  # [m]
    base = knobs.colour("base", (0.0, 1.0), (0.02, 0.3), (0.4, 0.85))
    pale = knobs.colour("pale", (0.0, 1.0), (0.0, 0.25), (0.7, 0.97))
    dark = knobs.colour("dark", (0.0, 1.0), (0.0, 0.3), (0.06, 0.26))
    rough = canvas.noise(rng, grain) + 0.7 * canvas.noise(rng, grain / 2)
    spots = canvas.noise(rng, grain * 0.8) + 0.6 * canvas.noise(rng, grain / 2)
    picture = mix(base, pale, step(0.15, 0.5, rough))
    amount = knobs.number("amount", 0.2, 0.65)
    return mix(picture, dark, step(amount, 0.25, spots)) * (
        1 + 0.05 * canvas.clouds(rng, 0.2, 3)[..., None]
    )


def terrazzo(canvas: Canvas, knobs: Knobs) -> Field:
    """Angular chips of stone in a plain ground."""
    rng, size = knobs.rng, knobs.number("size", 0.007, 0.02)  # [m] mean radius of a chip
    ground = knobs.colour("ground", (0.0, 1.0), (0.02, 0.2), (0.5, 0.95))
    palette = [knobs.colour(f"chip{k}", (0.0, 1.0), (0.1, 0.6), (0.2, 0.95)) for k in range(4)]
    picture = shaded(ground, 1 + 0.03 * canvas.noise(rng, 0.006) + 0.03 * canvas.noise(rng, 0.3))
    scale = canvas.columns / canvas.width
    cover = knobs.number("cover", 0.25, 0.55)
    count = min(int(cover * canvas.width * canvas.height / (2.6 * size**2)), 500)
    turns = np.linspace(0, 2 * np.pi, 6, endpoint=False)
    for _ in range(count):
        r = size * scale * float(rng.uniform(0.35, 1.5))
        cx, cy = rng.uniform(0, canvas.columns), rng.uniform(0, canvas.rows)
        x0, y0 = max(int(cx - r), 0), max(int(cy - r), 0)
        x1, y1 = min(int(cx + r) + 2, canvas.columns), min(int(cy + r) + 2, canvas.rows)
        dx = np.arange(x0, x1, dtype=np.float32)[None] - cx
        dy = np.arange(y0, y1, dtype=np.float32)[:, None] - cy
        angle = turns + rng.uniform(0, 0.9, 6)
        reach = r * rng.uniform(0.35, 0.95, 6)
        inside = np.ones((y1 - y0, x1 - x0), bool)
        for a, limit in zip(angle, reach, strict=True):
            inside &= dx * np.cos(a) + dy * np.sin(a) < limit
        tone = palette[int(rng.integers(4))] * np.float32(rng.uniform(0.85, 1.1))
        picture[y0:y1, x0:x1][inside] = tone
    return picture


def concrete(canvas: Canvas, knobs: Knobs) -> Field:
    """Cloudy, with pores and trowel marks."""
    rng = knobs.rng
    base = knobs.colour("base", (0.05, 0.7), (0.0, 0.16), (0.4, 0.82))
    rough = canvas.clouds(rng, knobs.number("cell", 0.1, 0.4), 7, 0.6)
    pores = step(knobs.number("pores", 0.68, 0.86), 0.05, canvas.noise(rng, 0.006))
    shade = 1 + knobs.number("depth", 0.06, 0.2) * rough - 0.4 * pores
    return shaded(base, shade * canvas.relief(canvas.noise(rng, 0.012, 0.003), 0.05))


def slate(canvas: Canvas, knobs: Knobs) -> Field:
    """Split stone with steps and a dark sheen."""
    rng = knobs.rng
    base = knobs.colour("base", (0.3, 0.8), (0.03, 0.28), (0.18, 0.5))
    heights = canvas.clouds(rng, knobs.number("cell", 0.06, 0.25), 6, 0.62)
    steps = np.floor(heights * knobs.number("steps", 3.0, 9.0)) / 6
    shade = canvas.relief(heights + 0.5 * steps, knobs.number("relief", 0.5, 1.4))
    return shaded(base, np.clip(shade, 0.4, 1.7) * (1 + 0.12 * heights))


def laminate(canvas: Canvas, knobs: Knobs) -> Field:
    """A plain kitchen top with fine flecks."""
    rng = knobs.rng
    base = knobs.colour("base", (0.0, 1.0), (0.0, 0.75), (0.15, 0.97))
    fleck = knobs.colour("fleck", (0.0, 1.0), (0.0, 0.5), (0.1, 0.95))
    size = knobs.number("size", 0.0025, 0.008)  # [m]
    amount = step(knobs.number("amount", 0.45, 0.9), 0.15, canvas.noise(rng, size))
    return mix(shaded(base, 1 + 0.02 * canvas.noise(rng, 0.2)), fleck, 0.6 * amount)


def brushed(canvas: Canvas, knobs: Knobs) -> Field:
    """Metal, brushed along x."""
    rng = knobs.rng
    base = knobs.colour("base", (0.05, 0.65), (0.0, 0.3), (0.45, 0.85))
    strength = knobs.number("strength", 0.06, 0.2)
    lines = canvas.noise(rng, 0.25, 0.0014) + 0.6 * canvas.noise(rng, 0.06, 0.0024)
    return shaded(base, 1 + strength * lines + 0.08 * canvas.noise(rng, 0.5, 0.25))


def stone_wall(canvas: Canvas, knobs: Knobs) -> Field:
    """Courses of blocks of changing length, with rough faces."""
    rng = knobs.rng
    base = knobs.colour("base", (0.02, 0.16), (0.03, 0.3), (0.4, 0.8))
    mortar = knobs.colour("mortar", (0.05, 0.6), (0.0, 0.15), (0.45, 0.85))
    tall, long = knobs.number("tall", 0.12, 0.3), knobs.number("long", 0.25, 0.6)  # [m]
    row = np.floor(canvas.y / tall)
    shift = per_cell(rng, row, 1.0) * long
    stretch = per_cell(rng, row + 77, 0.25)
    along = (canvas.x + shift) / (long * stretch)
    wobble = 0.05 * canvas.noise(rng, 0.06)
    down = canvas.y / np.float32(tall) - row
    edge = np.minimum(0.5 - np.abs(along - np.floor(along) - 0.5), 0.6 - 1.2 * np.abs(down - 0.5))
    face = step(0.03, 0.06, edge + wobble)
    rough = canvas.clouds(rng, 0.12, 6, 0.62)
    shade = canvas.relief(rough + 2 * face, knobs.number("relief", 0.25, 0.7))
    shade = np.clip(shade, 0.4, 1.6) * per_cell(rng, np.floor(along) * 17 + row * 5, 0.22)
    return mix(shaded(mortar, 1 + 0.1 * rough), shaded(base, shade), face)
