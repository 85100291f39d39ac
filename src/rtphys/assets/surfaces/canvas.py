"""What surfaces are drawn with: a canvas in metres, noise, relief, and parameters by split."""

from dataclasses import dataclass, field
from functools import cached_property
from typing import Any

import numpy as np
from numpy.random import Generator
from numpy.typing import ArrayLike, NDArray

Field = NDArray[np.floating[Any]]  # one number a pixel, (height, width), or a row or column of them
HELD_OUT = ((0.4, 0.5), (0.9, 1.0))  # of each parameter's range: shares that are unseen


@dataclass
class Knobs:
    """Draws the parameters of one surface and remembers them.

    Every parameter of an unseen surface lies in the held-out shares of its range, and none of a
    seen one does: the splits are disjoint in each parameter, not only in their seeds.
    """

    rng: Generator
    unseen: bool
    values: dict[str, float] = field(default_factory=dict[str, float])

    def number(self, name: str, low: float, high: float) -> float:
        """A parameter between `low` and `high`."""
        (a, b), (c, d) = HELD_OUT
        u = float(self.rng.random())
        if self.unseen:
            share = a + u * (b - a + d - c)
            share += c - b if share >= b else 0.0
        else:
            share = u * (c - b + a)
            share += b - a if share >= a else 0.0
        self.values[name] = low + share * (high - low)
        return self.values[name]

    def colour(
        self, name: str, hue: tuple[float, float], vivid: tuple[float, float], light: ArrayLike
    ) -> Field:
        """A colour (3,), sRGB: hue 0..1 around the wheel, saturation, largest channel."""
        low, high = np.asarray(light, float)
        h = self.number(f"{name}_hue", *hue) % 1
        s, v = self.number(f"{name}_vivid", *vivid), self.number(f"{name}_light", low, high)
        wheel = np.clip(np.abs((h * 6 + np.array([0, 4, 2])) % 6 - 3) - 1, 0, 1)
        return (v * (1 - s + s * wheel)).astype(np.float32)


@dataclass(frozen=True)
class Canvas:
    """A rectangle of a surface. Rows go down, x to the right, both from the top left corner."""

    width: float  # [m]
    height: float  # [m]
    columns: int
    rows: int

    @cached_property
    def x(self) -> Field:
        """(1, columns) [m]."""
        return ((np.arange(self.columns, dtype=np.float32) + 0.5) * (self.width / self.columns))[
            None
        ].astype(np.float32)

    @cached_property
    def y(self) -> Field:
        """(rows, 1) [m]."""
        return ((np.arange(self.rows, dtype=np.float32) + 0.5) * (self.height / self.rows))[
            :, None
        ].astype(np.float32)

    def strip(self, first: int, last: int) -> "Canvas":
        """Rows `first` to before `last` as a canvas of their own."""
        return Canvas(
            self.width, self.height * (last - first) / self.rows, self.columns, last - first
        )

    def turned(self) -> "Canvas":
        """The same with x and y exchanged; transpose what is drawn on it."""
        return Canvas(self.height, self.width, self.rows, self.columns)

    def noise(self, rng: Generator, cell_x: float, cell_y: float | None = None) -> Field:
        """Smooth noise (rows, columns) in -1..1, its lattice `cell_x` by `cell_y` wide [m]."""
        i, s = _lattice(self.y[:, 0], cell_x if cell_y is None else cell_y)
        j, t = _lattice(self.x[0], cell_x)
        corners = rng.uniform(-1, 1, (int(i[-1]) + 2, int(j[-1]) + 2)).astype(np.float32)
        along = corners[:, j] * (1 - t) + corners[:, j + 1] * t
        s = s[:, None]
        return along[i] * (1 - s) + along[i + 1] * s

    def clouds(self, rng: Generator, cell: float, octaves: int = 5, fade: float = 0.55) -> Field:
        """Noises summed, each half as wide and `fade` times as strong as the last; about -1..1."""
        total = self.noise(rng, cell)
        for k in range(1, octaves):
            total += self.noise(rng, cell / 2**k) * np.float32(fade**k)
        return total * np.float32(1.6 * (1 - fade) / (1 - fade**octaves))

    def relief(self, heights: Field, strength: float) -> Field:
        """Shading about 1 of a height field that is lit from the upper left."""
        shade = np.ones_like(heights)
        shade[1:, 1:] += np.float32(strength) * (
            2 * heights[1:, 1:] - heights[:-1, 1:] - heights[1:, :-1]
        )
        return shade


def _lattice(at: Field, cell: float) -> tuple[NDArray[np.intp], Field]:
    """Index of the lattice point before each place, and the smooth share of the next one."""
    place = at / np.float32(cell)
    i = np.floor(place).astype(np.intp)
    t = (place - i).astype(np.float32)
    return i, t * t * (3 - 2 * t)


def step(edge: float, width: float, value: Field) -> Field:
    """0 below `edge`, 1 above `edge + width`, smooth between."""
    t = np.clip((value - np.float32(edge)) / np.float32(width), 0, 1)
    return t * t * (3 - 2 * t)


def mix(a: ArrayLike, b: ArrayLike, share: Field) -> Field:
    """Colours (3,) or pictures between a (share 0) and b (share 1), (rows, columns, 3)."""
    first, second = np.asarray(a, np.float32), np.asarray(b, np.float32)
    return first + (second - first) * share[..., None]


def shaded(colour: ArrayLike, shade: Field) -> Field:
    """A colour (3,) or a picture, made lighter and darker."""
    return np.asarray(colour, np.float32) * shade[..., None]


def per_cell(rng: Generator, index: ArrayLike, spread: float) -> Field:
    """A factor about 1 of each cell, by its whole number (any shape)."""
    table = rng.uniform(1 - spread, 1 + spread, 4096).astype(np.float32)
    return table[np.asarray(index, np.int64) % 4096]
