"""Figure of success against each attribute: rates in bins with intervals, and the fitted curve."""

from collections.abc import Sequence
from pathlib import Path

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from rtphys.results.breaks import Break

COLUMNS = 4
UNLIKELY = 0.05  # adjusted p-value below which a panel's title is red


def draw_breaks(effects: Sequence[Break], title: str, path: Path) -> None:
    """Write a PNG with one panel per attribute, in the order given."""
    rows = max(1, -(-len(effects) // COLUMNS))
    figure = Figure(figsize=(3.2 * COLUMNS, 2.4 * rows + 0.4), layout="constrained")
    panels = np.ravel(figure.subplots(rows, COLUMNS, squeeze=False, sharey=True))
    for panel, effect in zip(panels, effects, strict=False):
        _draw(panel, effect)
    for panel in panels[len(effects) :]:
        panel.set_axis_off()
    figure.suptitle(title)
    figure.savefig(path, dpi=120)


def _draw(panel: Axes, effect: Break) -> None:
    curve = effect.curve
    middles = [(a + b) / 2 for a, b, _ in effect.bins]
    rates = np.array([rate.value or 0.0 for _, _, rate in effect.bins])
    bounds = np.array([rate.interval for _, _, rate in effect.bins])
    whiskers = np.abs(bounds - rates[:, None]).T
    panel.errorbar(middles, rates, yerr=whiskers, fmt="o", ms=4, lw=1, color="0.4", capsize=2)
    x = np.linspace(curve.low, curve.high, 100)
    panel.plot(x, curve.at(x), color="C0")
    colour = "C3" if effect.p_holm < UNLIKELY else "k"
    names = ", ".join([effect.key, *effect.same])
    title = f"{names} [{effect.unit}]\nlog-odds {curve.slope:+.1f}, p = {effect.p_holm:.2g}"
    panel.set_title(title, fontsize=8, color=colour)
    panel.set_ylim(-0.03, 1.03)
    panel.tick_params(labelsize=7)
