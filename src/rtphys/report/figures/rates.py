"""Figure of success rates with intervals: one row per task, one colour per policy."""

from collections.abc import Mapping, Sequence
from pathlib import Path

from matplotlib.figure import Figure

from rtphys.results.statistics import Rate

ROW = 0.24  # [inch] smallest height of a task's row

Rates = Sequence[tuple[str, Mapping[str, Rate]]]  # label, rate by task


def draw_rates(columns: Rates, tasks: Sequence[str], title: str, path: Path) -> None:
    """Write a PNG; dots are success rates, whiskers their 95 % intervals."""
    height = 1.4 + len(tasks) * max(ROW, 0.09 * len(columns))
    figure = Figure(figsize=(8.0, height), layout="constrained")
    axes = figure.subplots()
    for i, (label, rates) in enumerate(columns):
        known = [(row, rates[task]) for row, task in enumerate(tasks) if task in rates]
        shown = [(row, rate, value) for row, rate in known if (value := rate.value) is not None]
        offset = 0.7 * ((i + 0.5) / len(columns) - 0.5)
        axes.errorbar(
            [100 * value for _, _, value in shown],
            [row + offset for row, _, _ in shown],
            xerr=[
                [100 * (value - rate.interval[0]) for _, rate, value in shown],
                [100 * (rate.interval[1] - value) for _, rate, value in shown],
            ],
            fmt="o",
            ms=3,
            lw=0.9,
            color=f"C{i % 10}",
            label=label,
        )
    axes.set_yticks(range(len(tasks)), tasks, fontsize=8)
    axes.set_ylim(len(tasks) - 0.5, -0.5)
    axes.set_xlim(-2, 102)
    axes.set_xlabel("success [%]")
    axes.grid(axis="x", alpha=0.3)
    for row in range(1, len(tasks)):
        axes.axhline(row - 0.5, color="0.9", lw=0.6)
    figure.suptitle(title)
    figure.legend(loc="outside lower center", ncols=2, fontsize=8)
    figure.savefig(path, dpi=120)
