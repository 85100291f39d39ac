"""Figures of studies: maps, success rates, what breaks a policy, what feasibility selects."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from io import BytesIO
from pathlib import Path
from typing import Any, TypeVar

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from rtphys.core.poses import Array
from rtphys.data import files
from rtphys.laws.audit.selection import UNLIKELY, Selection
from rtphys.results.breaks import SIGNIFICANT, Break
from rtphys.results.statistics import Rate

# ---- files ---------------------------------------------------------------------------------------


def save(figure: Figure, path: Path, dpi: int) -> None:
    """Raises `CannotWrite`."""
    files.make_folder(path.parent)
    files.replace_file(path, _bytes(figure, dpi, path.suffix[1:] or "png"))


def _bytes(figure: Figure, dpi: int, kind: str = "png") -> bytes:
    buffer = BytesIO()
    figure.savefig(buffer, format=kind, dpi=dpi)
    return buffer.getvalue()


# ---- maps of task by attribute -------------------------------------------------------------------

T = TypeVar("T")
MANY = 20  # tasks
NOTHING = "0.85"  # grey of a cell whose attribute does not act, or was not measured
Cells = Mapping[str, Mapping[str, float]]  # task -> attribute -> value from 0 to 1


@dataclass(frozen=True)
class Scale:
    """What the numbers of a map mean, and their colours."""

    label: str
    colours: str  # matplotlib's name


SENSITIVITY = Scale("tolerated share of the range [%]", "RdYlGn")
IDENTIFIABILITY = Scale("R² on seeds not learnt from [%]", "viridis")


def tolerated_shares(results: Sequence[Mapping[str, Any]]) -> dict[str, dict[str, float]]:
    """Task -> attribute -> tolerated share of its range, from the results of `sensitivity`."""
    return {
        result["task"]: {key: of["share"] for key, of in result["attributes"].items()}
        for result in results
    }


def draw_task_map(cells: Cells, scale: Scale, path: Path) -> None:
    """Draw tasks and attributes, numbers in percent. Few tasks are rows, many columns.

    Values outside 0 to 1 are drawn as the nearer of these.
    """
    panel, shares, wide = empty_map(cells, lambda share: 100 * np.clip(share, 0, 1))
    image = panel.imshow(shares, vmin=0, vmax=100, cmap=scale.colours, aspect="auto")
    for (row, column), share in np.ndenumerate(shares):
        if np.isfinite(share):
            red, green, blue, _ = image.cmap(share / 100)
            colour = "k" if 0.3 * red + 0.6 * green + 0.1 * blue > 0.45 else "w"
            style = {"fontsize": 5 if wide else 7, "color": colour, "ha": "center", "va": "center"}
            panel.text(column, row, f"{share:.0f}", **style)
    bar = panel.figure.colorbar(image, ax=panel, shrink=0.6, pad=0.01)
    bar.set_label(scale.label, fontsize=8)
    bar.ax.tick_params(labelsize=7)
    save(panel.figure, path, 150)


def empty_map(
    cells: Mapping[str, Mapping[str, T]], value: Callable[[T], float]
) -> tuple[Any, Array, bool]:
    """Axes of an empty map, its numbers (nan where there is none), and whether tasks are columns.

    A page is wider than high, so many tasks are columns.
    """
    tasks, keys = sorted(cells), sorted({key for of in cells.values() for key in of})
    rows = [[value(cells[t][k]) if k in cells[t] else np.nan for k in keys] for t in tasks]
    table, wide = np.array(rows, float).reshape(len(tasks), len(keys)), len(tasks) > MANY
    names = [key.replace("_", " ") for key in keys]
    down, across = (names, tasks) if wide else (tasks, names)
    width, height = (0.23, 0.23) if wide else (0.6, 0.2)  # [inch] of a cell
    size = (2.6 + width * len(across), 1.9 + height * len(down))
    panel = Figure(figsize=size, layout="constrained").subplots()
    panel.set_facecolor(NOTHING)
    panel.set_xticks(range(len(across)), across, rotation=60, ha="right")
    panel.set_yticks(range(len(down)), down)
    panel.tick_params(labelsize=7)
    return panel, table.T if wide else table, wide


# ---- success rates by task and policy --------------------------------------------------------

ROW = 0.24  # [inch] smallest height of a task's row
Rates = Sequence[tuple[str, Mapping[str, Rate]]]  # label of a column, its rate by task


def draw_rates(columns: Rates, tasks: Sequence[str], title: str, path: Path) -> None:
    """Draw a row a task, a colour a column; whiskers are 95 % intervals."""
    height = 1.4 + len(tasks) * max(ROW, 0.09 * len(columns))
    figure = Figure(figsize=(8.0, height), layout="constrained")
    axes = figure.subplots()
    marks = list[Any]()
    for i, (_, rates) in enumerate(columns):
        rows = [(row, rates[task]) for row, task in enumerate(tasks) if task in rates]
        shown = [(row, rate.value, *rate.interval) for row, rate in rows if rate.value is not None]
        row, value, low, high = np.array(shown, float).reshape(-1, 4).T
        offset = 0.7 * ((i + 0.5) / len(columns) - 0.5)
        whiskers = 100 * np.array([value - low, high - value])
        style = {"fmt": "o", "ms": 3, "lw": 0.9, "color": f"C{i % 10}"}
        marks.append(axes.errorbar(100 * value, row + offset, xerr=whiskers, **style))
    axes.set_yticks(range(len(tasks)), tasks, fontsize=8)
    axes.set_ylim(len(tasks) - 0.5, -0.5)
    axes.set_xlim(-2, 102)
    axes.set_xlabel("success [%]")
    axes.grid(axis="x", alpha=0.3)
    for row in range(1, len(tasks)):
        axes.axhline(row - 0.5, color="0.9", lw=0.6)
    figure.suptitle(title)
    labels = [label.replace("$", r"\$") for label, _ in columns]  # no formula
    # Named one by one: matplotlib leaves out what begins with an underscore.
    figure.legend(marks, labels, loc="outside lower center", ncols=2, fontsize=8)
    save(figure, path, 120)


# ---- a panel for each attribute ------------------------------------------------------------------

COLUMNS = 4  # of panels
BINS = 12  # of a histogram


def draw_breaks(effects: Sequence[Break], title: str) -> bytes:
    """A PNG of success against each attribute: rates in bins, and the fitted curve."""
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
    return _bytes(figure, 120)


def _panels(count: int, sharey: bool = False) -> tuple[Figure, list[Axes]]:
    """A figure with so many panels, `COLUMNS` beside each other."""
    rows = max(1, -(-count // COLUMNS))
    figure = Figure(figsize=(3.2 * COLUMNS, 2.4 * rows + 0.4), layout="constrained")
    panels = [*np.ravel(figure.subplots(rows, COLUMNS, squeeze=False, sharey=sharey))]
    for panel in panels[count:]:
        panel.set_axis_off()
    return figure, panels[:count]


def draw_selections(selections: list[Selection], title: str, path: Path) -> None:
    """Draw each attribute's accepted values against the attempted ones.

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
    save(figure, path, 120)
