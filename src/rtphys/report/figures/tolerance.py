"""Map of task by attribute: the part of each range in which a task is still solved."""

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import cast

import numpy as np
from matplotlib.figure import Figure

from rtphys.data.episode import JSON

NOTHING = "0.85"  # grey of a cell whose attribute does not act, or was not measured


def draw_tolerance(results: Sequence[Mapping[str, JSON]], path: Path) -> None:
    """Write a PNG: a row for each task, a column for each attribute.

    A cell's number and colour are the tolerated share of the attribute's range [%].

    Args:
        results: of `sensitivity`.
    """
    answers = {
        str(r["task"]): cast(Mapping[str, Mapping[str, float]], r["attributes"]) for r in results
    }
    tasks = sorted(answers)
    keys = sorted({key for known in answers.values() for key in known})
    shares = np.array(
        [[answers[t][k]["share"] if k in answers[t] else np.nan for k in keys] for t in tasks]
    ).reshape(len(tasks), len(keys))
    figure = Figure(figsize=(2.6 + 0.6 * len(keys), 1.9 + 0.2 * len(tasks)), layout="constrained")
    panel = figure.subplots()
    panel.set_facecolor(NOTHING)
    image = panel.imshow(shares, vmin=0, vmax=1, cmap="RdYlGn", aspect="auto")
    for (row, column), share in np.ndenumerate(shares):
        if np.isfinite(share):
            colour = "k" if 0.15 < share < 0.85 else "w"  # the ends of the colour map are dark
            text = f"{100 * share:.0f}"
            panel.text(column, row, text, ha="center", va="center", fontsize=7, color=colour)
    panel.set_xticks(range(len(keys)), [k.replace("_", " ") for k in keys], rotation=60, ha="right")
    panel.set_yticks(range(len(tasks)), tasks)
    panel.tick_params(labelsize=7)
    bar = figure.colorbar(image, ax=panel, shrink=0.6)
    bar.set_label("tolerated share of the range", fontsize=8)
    bar.ax.tick_params(labelsize=7)
    figure.savefig(path, dpi=150)
