"""Figure of each attribute's accepted values against the attempted ones, as histograms."""

from pathlib import Path

import numpy as np
from matplotlib.figure import Figure

from rtphys.proofs.audit_selection import UNLIKELY, Selection

COLUMNS, BINS = 4, 12


def draw_selections(selections: list[Selection], title: str, path: Path) -> None:
    """Write a PNG; a red title marks an attribute whose distribution feasibility has changed."""
    rows = max(1, -(-len(selections) // COLUMNS))
    figure = Figure(figsize=(3.2 * COLUMNS, 2.4 * rows), layout="constrained")
    panels = np.ravel(figure.subplots(rows, COLUMNS, squeeze=False))
    for panel, selection in zip(panels, selections, strict=False):
        attempted = selection.attempted
        edges = np.linspace(attempted.min(), attempted.max(), BINS + 1)
        panel.hist(attempted, edges, color="0.8", label="attempted")
        panel.hist(attempted[selection.accepted], edges, color="C0", label="accepted")
        title = f"{selection.key} [{selection.unit}]  p = {selection.p:.2g}"
        panel.set_title(title, fontsize=8, color="C3" if selection.p < UNLIKELY else "k")
        panel.tick_params(labelsize=7)
    for panel in panels[len(selections) :]:
        panel.set_axis_off()
    if selections:
        panels[0].legend(fontsize=7)
    figure.suptitle(title)
    figure.savefig(path, dpi=120)
