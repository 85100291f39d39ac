"""Success against each attribute: rates in bins with their intervals, and the logistic curve."""

from collections.abc import Sequence
from pathlib import Path

import matplotlib

matplotlib.use("Agg")  # no display needed

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from rtphys.results.breaks import Break

COLUMNS = 4
UNLIKELY = 0.05  # adjusted p-value below which a panel's title is red


def draw_breaks(found: Sequence[Break], title: str, path: Path) -> None:
    """Write a PNG, one panel an attribute, in the order given."""
    rows = max(1, -(-len(found) // COLUMNS))
    figure = Figure(figsize=(3.2 * COLUMNS, 2.4 * rows + 0.4), layout="constrained")
    panels = np.ravel(figure.subplots(rows, COLUMNS, squeeze=False, sharey=True))
    for panel, one in zip(panels, found, strict=False):
        _draw(panel, one)
    for panel in panels[len(found) :]:
        panel.set_axis_off()
    figure.suptitle(title)
    figure.savefig(path, dpi=120)


def _draw(panel: Axes, one: Break) -> None:
    middles = [(a + b) / 2 for a, b, _ in one.bins]
    rates = np.array([rate.value or 0.0 for _, _, rate in one.bins])
    ends = np.array([rate.interval for _, _, rate in one.bins])
    away = np.abs(ends - rates[:, None]).T
    panel.errorbar(middles, rates, yerr=away, fmt="o", ms=4, lw=1, color="0.4", capsize=2)
    x = np.linspace(one.curve.low, one.curve.high, 100)
    panel.plot(x, one.curve.at(x), color="C0")
    colour = "C3" if one.p_holm < UNLIKELY else "k"
    names = ", ".join([one.key, *one.same])
    told = f"{names} [{one.unit}]\nlog-odds {one.curve.slope:+.1f}, p = {one.p_holm:.2g}"
    panel.set_title(told, fontsize=8, color=colour)
    panel.set_ylim(-0.03, 1.03)
    panel.tick_params(labelsize=7)
