"""Which attribute breaks a task, and whether a robot could identify it there: docs/maps.md."""

from collections.abc import Mapping
from enum import Enum
from pathlib import Path

from matplotlib.colors import ListedColormap
from matplotlib.patches import Patch

from rtphys.report import figures

IDENTIFIABLE = 0.5  # R² from which an attribute counts as identifiable


class Relevance(Enum):
    """Whether an attribute breaks a task, and whether a robot could identify it there."""

    BREAKS_IDENTIFIABLE = "breaks, identifiable"
    BREAKS_HIDDEN = "breaks, not identifiable"
    HARMLESS_IDENTIFIABLE = "harmless, identifiable"
    HARMLESS_HIDDEN = "harmless, not identifiable"


COLOURS = {  # colour-blind readers can distinguish them
    Relevance.BREAKS_IDENTIFIABLE: "#d55e00",
    Relevance.BREAKS_HIDDEN: "#882255",
    Relevance.HARMLESS_IDENTIFIABLE: "#56b4e9",
    Relevance.HARMLESS_HIDDEN: "#f5f5f5",
}


def relevance(tolerated: figures.Cells, r2: figures.Cells) -> dict[str, dict[str, Relevance]]:
    """Sensitivity x identifiability of each task and attribute for which both were measured.

    An attribute breaks a task where not its whole range is tolerated.
    """
    found: dict[str, dict[str, Relevance]] = {}
    for task, shares in tolerated.items():
        for key in sorted(shares.keys() & r2.get(task, {}).keys()):
            breaks = "breaks" if shares[key] < 1 else "harmless"
            identifiable = "" if r2[task][key] >= IDENTIFIABLE else "not "
            found.setdefault(task, {})[key] = Relevance(f"{breaks}, {identifiable}identifiable")
    return found


def draw_relevance(cells: Mapping[str, Mapping[str, Relevance]], path: Path) -> None:
    """Draw which attribute breaks a task, and which could be identified in it."""
    order, colours = list(COLOURS), list(COLOURS.values())
    panel, values, wide = figures.empty_map(cells, order.index)
    shown = {"cmap": ListedColormap(colours), "vmin": -0.5, "vmax": len(order) - 0.5}
    panel.imshow(values, aspect="auto", **shown)
    named = [Patch(facecolor=c, edgecolor="0.5", label=r.value) for r, c in COLOURS.items()]
    named.append(Patch(facecolor=figures.NOTHING, label="does not act, or not measured"))
    place = {"loc": "outside upper center", "ncols": len(named) if wide else 3}
    panel.figure.legend(handles=named, fontsize=7, frameon=False, **place)
    figures.save(panel.figure, path, 150)
