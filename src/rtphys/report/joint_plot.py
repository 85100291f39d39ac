"""Targets against measured joints over time, the expert's stages marked, as SVG."""

from collections.abc import Sequence
from dataclasses import dataclass
from html import escape
from itertools import pairwise

import numpy as np

from rtphys.data.dataset import Episode
from rtphys.data.episode import Floats, Frames

WIDTH, HEIGHT, LEFT, TOP = 460, 92, 78, 40  # of one panel, and around them [px]
TARGET, MEASURED = "#d1495b", "#1f7a8c"
SMALLEST = 0.02  # [rad or m] that a panel spans
BANDS = ("#eef2f6", "#ffffff")
OPENING = (-0.01, 0.045)  # finger joint at commanded opening 0 and 1 [m], aloha-agilex


@dataclass(frozen=True)
class Panel:
    """One joint."""

    title: str
    target: Floats  # (T,)
    measured: Floats | None  # (T,), None where no joint of that name was recorded


def panels(frames: Frames) -> list[Panel]:
    """Six joints and the gripper of each arm, left arm first."""
    found = []
    names = {name: n for n, name in enumerate(frames.joint_names)}

    def measured(name: str) -> Floats | None:
        return frames.qpos[:, names[name]] if name in names else None

    for side, prefix in (("left", "fl"), ("right", "fr")):
        angles = getattr(frames, f"{side}_arm")
        found += [
            Panel(f"{side} {k + 1} [rad]", angles[:, k], measured(f"{prefix}_joint{k + 1}"))
            for k in range(6)
        ]
        opening = OPENING[0] + getattr(frames, f"{side}_gripper") * (OPENING[1] - OPENING[0])
        found.append(Panel(f"{side} finger [m]", opening, measured(f"{prefix}_joint7")))
    return found


def joint_plot(episode: Episode) -> str:
    """An SVG document: left arm in the left column, right arm in the right one."""
    frames = episode.frames
    parts = [_bands(frames, column) for column in (0, 1)]
    for n, panel in enumerate(panels(frames)):
        parts.append(_panel(panel, frames.time, n // 7, n % 7))
    title = escape(f"{episode.task} {episode.number}, seed {episode.seed}, {episode.protocol}")
    key = (
        f'<text x="{LEFT}" y="30"><tspan fill="{TARGET}">commanded</tspan> '
        f'<tspan fill="{MEASURED}">measured</tspan> over {frames.time[-1]:.1f} s</text>'
    )
    width, height = 2 * (WIDTH + LEFT) + 10, 7 * HEIGHT + TOP + 24
    return (
        f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {width} {height}" '
        'font-family="sans-serif" font-size="11" fill="#1d2733">'
        f'<rect width="100%" height="100%" fill="#ffffff"/>'
        f'<text x="{LEFT}" y="15" font-weight="bold">{title}</text>{key}{"".join(parts)}</svg>\n'
    )


def _x(time: Floats, at: float, column: int) -> float:
    span = float(time[-1] - time[0]) or 1.0
    return LEFT + column * (WIDTH + LEFT) + WIDTH * (at - float(time[0])) / span


def _bands(frames: Frames, column: int) -> str:
    """A band for each stretch of one stage, its name below."""
    edges = [0, *(np.flatnonzero(np.diff(frames.stage)) + 1).tolist(), len(frames) - 1]
    parts = []
    for n, (first, last) in enumerate(pairwise(edges)):
        x, end = (_x(frames.time, float(frames.time[t]), column) for t in (first, last))
        name = escape(frames.stages[int(frames.stage[first])])
        below = TOP + 7 * HEIGHT + 12 + 9 * (n % 2)  # neighbours' names on two lines
        parts.append(
            f'<rect x="{x:.1f}" y="{TOP}" width="{end - x:.1f}" height="{7 * HEIGHT}" '
            f'fill="{BANDS[n % 2]}"/><text x="{x + 2:.1f}" y="{below}" '
            f'font-size="9" fill="#66727f">{name}</text>'
        )
    return "".join(parts)


def _panel(panel: Panel, time: Floats, column: int, row: int) -> str:
    shown = [panel.target, *([panel.measured] if panel.measured is not None else [])]
    low = min(float(line.min()) for line in shown)
    high = max(float(line.max()) for line in shown)
    if high - low < SMALLEST:  # a joint at rest is a flat line, not magnified noise
        low, high = (low + high - SMALLEST) / 2, (low + high + SMALLEST) / 2
    top, left = TOP + row * HEIGHT, column * (WIDTH + LEFT)
    lines = [
        _line(line, time, (low, high), (column, top), colour)
        for line, colour in zip(shown, (TARGET, MEASURED), strict=False)
    ]
    scale = [
        f'<text x="{left + LEFT - 4}" y="{y}" text-anchor="end" font-size="9">{value:.2f}</text>'
        for y, value in ((top + 14, high), (top + HEIGHT - 8, low))
    ]
    title = f'<text x="{left + 4}" y="{top + HEIGHT / 2}">{escape(panel.title)}</text>'
    return "".join([title, *scale, *lines])


def _line(
    values: Floats,
    time: Floats,
    limits: tuple[float, float],
    place: tuple[int, float],
    colour: str,
) -> str:
    (low, high), (column, top) = limits, place
    span = (high - low) or 1.0
    points: Sequence[str] = [
        f"{_x(time, float(t), column):.1f},{top + 8 + (HEIGHT - 16) * (1 - (v - low) / span):.1f}"
        for t, v in zip(time, values, strict=True)
    ]
    return (
        f'<polyline points="{" ".join(points)}" fill="none" stroke="{colour}" stroke-width="1.3"/>'
    )
