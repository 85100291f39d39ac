"""Figures of an evaluation, and of what feasibility selects."""

from collections.abc import Sequence
from pathlib import Path

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from rtphys.laws.audit.selection import UNLIKELY, Selection
from rtphys.results.breaks import SIGNIFICANT, Break

COLUMNS = 4  # of panels
BINS = 12  # of a histogram


def draw_breaks(effects: Sequence[Break], title: str, path: Path) -> None:
    """Write a PNG of success against each attribute: rates in bins, and the fitted curve."""
    figure, panels = _panels(len(effects), sharey=True)
    for panel, effect in zip(panels, effects, strict=True):
        curve, x = effect.curve, np.linspace(effect.curve.low, effect.curve.high, 100)
        middles = [(a + b) / 2 for a, b, _ in effect.bins]
        rates = np.array([rate.value or 0.0 for _, _, rate in effect.bins])
        bounds = np.array([rate.interval for _, _, rate in effect.bins])
        style = {"fmt": "o", "ms": 4, "lw": 1, "color": "0.4", "capsize": 2}
        panel.errorbar(middles, rates, yerr=np.abs(bounds - rates[:, None]).T, **style)
        panel.plot(x, curve.at(x), color="C0")
        numbers = f"log-odds {curve.slope:+.1f}, p (Holm) = {effect.p_holm:.2g}"
        colour = "C3" if effect.p_holm < SIGNIFICANT else "k"
        panel.set_title(f"{effect.names} [{effect.unit}]\n{numbers}", fontsize=8, color=colour)
        panel.set_ylim(-0.03, 1.03)
        panel.tick_params(labelsize=7)
    figure.suptitle(title)
    figure.savefig(path, dpi=120)


def _panels(count: int, sharey: bool = False) -> tuple[Figure, list[Axes]]:
    """A figure with so many panels, `COLUMNS` beside each other."""
    rows = max(1, -(-count // COLUMNS))
    figure = Figure(figsize=(3.2 * COLUMNS, 2.4 * rows + 0.4), layout="constrained")
    panels = [*np.ravel(figure.subplots(rows, COLUMNS, squeeze=False, sharey=sharey))]
    for panel in panels[count:]:
        panel.set_axis_off()
    return figure, panels[:count]


def draw_selections(selections: list[Selection], title: str, path: Path) -> None:
    """Write a PNG of each attribute's accepted values against the attempted ones.

    A red title marks an attribute whose distribution feasibility has changed.
    """
    figure, panels = _panels(len(selections))
    for panel, selection in zip(panels, selections, strict=True):
        attempted = selection.attempted
        edges = np.linspace(attempted.min(), attempted.max(), BINS + 1)
        panel.hist(attempted, edges, color="0.8", label="attempted")
        panel.hist(attempted[selection.accepted], edges, color="C0", label="accepted")
        named = f"{selection.key} [{selection.unit}]  p = {selection.p:.2g}"
        panel.set_title(named, fontsize=8, color="C3" if selection.p < UNLIKELY else "k")
        panel.tick_params(labelsize=7)
    if selections:
        panels[0].legend(fontsize=7)
    figure.suptitle(title)
    figure.savefig(path, dpi=120)
