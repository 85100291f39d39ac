"""Maps of task by attribute: how much of a range is tolerated, how well it can be read, or both."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from matplotlib.colors import ListedColormap
from matplotlib.figure import Figure
from matplotlib.patches import Patch

from rtphys.core.poses import Array
from rtphys.results.quarters import Quarter

MANY = 20  # tasks
NOTHING = "0.85"  # grey of a cell whose attribute does not act, or was not measured
COLOURS = {  # of the quarters; colour-blind readers can distinguish them
    Quarter.BITES_AND_SHOWS: "#d55e00",
    Quarter.BITES_UNSEEN: "#882255",
    Quarter.SHOWS_HARMLESS: "#56b4e9",
    Quarter.NEITHER: "#f5f5f5",
}
Cells = Mapping[str, Mapping[str, float]]  # task -> attribute -> value from 0 to 1


@dataclass(frozen=True)
class Scale:
    """What the numbers of a map mean, and their colours."""

    label: str
    colours: str  # matplotlib's name


TOLERANCE = Scale("tolerated share of the range [%]", "RdYlGn")
READABILITY = Scale("R² on seeds not learnt from [%]", "viridis")


def draw_task_map(cells: Cells, scale: Scale, path: Path) -> None:
    """Write a PNG of tasks and attributes, numbers in percent. Few tasks are rows, many columns.

    Values outside 0 to 1 are drawn as the nearer of these.
    """
    grid = _Grid(cells)
    shares = 100 * np.clip(grid.numbers(lambda task, key: cells[task][key]), 0, 1)
    image = grid.panel.imshow(shares, vmin=0, vmax=100, cmap=scale.colours, aspect="auto")
    for (row, column), share in np.ndenumerate(shares):
        if np.isfinite(share):
            red, green, blue, _ = image.cmap(share / 100)
            colour = "k" if 0.3 * red + 0.6 * green + 0.1 * blue > 0.45 else "w"
            size = 5 if grid.wide else 7
            label = grid.panel.text(column, row, f"{share:.0f}", fontsize=size, color=colour)
            label.set(ha="center", va="center")
    bar = grid.figure.colorbar(image, ax=grid.panel, shrink=0.6, pad=0.01)
    bar.set_label(scale.label, fontsize=8)
    bar.ax.tick_params(labelsize=7)
    grid.figure.savefig(path, dpi=150)


def draw_quarters(cells: Mapping[str, Mapping[str, Quarter]], path: Path) -> None:
    """Write a PNG: which attribute breaks a task, and which leaves a trace in it."""
    grid, order = _Grid(cells), list(COLOURS)
    values = grid.numbers(lambda task, key: order.index(cells[task][key]))
    colours = ListedColormap(list(COLOURS.values()))
    grid.panel.imshow(values, vmin=-0.5, vmax=len(order) - 0.5, cmap=colours, aspect="auto")
    named = [Patch(facecolor=c, edgecolor="0.5", label=q.value) for q, c in COLOURS.items()]
    named.append(Patch(facecolor=NOTHING, label="does not act, or not measured"))
    columns = len(named) if grid.wide else 3
    grid.figure.legend(
        handles=named, loc="outside upper center", ncols=columns, fontsize=7, frameon=False
    )
    grid.figure.savefig(path, dpi=150)


class _Grid:
    """An empty map. A page is wider than high, so many tasks are columns."""

    def __init__(self, cells: Mapping[str, Mapping[str, object]]) -> None:
        self._cells = cells
        self._tasks = sorted(cells)
        self._keys = sorted({key for known in cells.values() for key in known})
        self.wide = len(self._tasks) > MANY
        names = [key.replace("_", " ") for key in self._keys]
        rows, columns = (names, self._tasks) if self.wide else (self._tasks, names)
        across, down = (0.23, 0.23) if self.wide else (0.6, 0.2)  # [inch] of a cell
        size = (2.6 + across * len(columns), 1.9 + down * len(rows))
        self.figure = Figure(figsize=size, layout="constrained")
        self.panel = self.figure.subplots()
        self.panel.set_facecolor(NOTHING)
        self.panel.set_xticks(range(len(columns)), columns, rotation=60, ha="right")
        self.panel.set_yticks(range(len(rows)), rows)
        self.panel.tick_params(labelsize=7)

    def numbers(self, value: Callable[[str, str], float]) -> Array:
        """The map's numbers, nan where there is none."""
        found = [
            [value(task, key) if key in self._cells[task] else np.nan for key in self._keys]
            for task in self._tasks
        ]
        table = np.array(found, float).reshape(len(self._tasks), len(self._keys))
        return table.T if self.wide else table
