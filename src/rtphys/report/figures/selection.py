"""Histograms of accepted against attempted values, one panel an attribute."""

from pathlib import Path

import matplotlib

matplotlib.use("Agg")  # no display needed

import numpy as np
from matplotlib.figure import Figure

from rtphys.proofs.audit_selection import UNLIKELY, Selection

COLUMNS, BINS = 4, 12


def draw_selections(found: list[Selection], title: str, path: Path) -> None:
    """Write a PNG; a red title marks an attribute whose distribution feasibility has cut."""
    rows = max(1, -(-len(found) // COLUMNS))
    figure = Figure(figsize=(3.2 * COLUMNS, 2.4 * rows), layout="constrained")
    panels = np.ravel(figure.subplots(rows, COLUMNS, squeeze=False))
    for panel, one in zip(panels, found, strict=False):
        edges = np.linspace(one.attempted.min(), one.attempted.max(), BINS + 1)
        panel.hist(one.attempted, edges, color="0.8", label="attempted")
        panel.hist(one.attempted[one.accepted], edges, color="C0", label="accepted")
        colour = "C3" if one.p < UNLIKELY else "k"
        panel.set_title(f"{one.key} [{one.unit}]  p = {one.p:.2g}", fontsize=8, color=colour)
        panel.tick_params(labelsize=7)
    for panel in panels[len(found) :]:
        panel.set_axis_off()
    if found:
        panels[0].legend(fontsize=7)
    figure.suptitle(title)
    figure.savefig(path, dpi=120)
