"""Tables and figure of what Training Set v1 holds, for docs/training_set.md: `scripts/coverage.py`.

Both are made from manifests/training_v1.digests.json and docs/results/training_v1.parquet alone,
which scripts/training_set.py writes.
"""

from collections.abc import Iterator, Mapping, Sequence
from functools import cache
from pathlib import Path

import numpy as np
import pyarrow.parquet as pq
import scipy
from numpy.typing import NDArray

from rtphys.data import schema
from rtphys.data.state_digests import Digests
from rtphys.physics import attributes
from rtphys.results.statistics import holm

ROOT = Path(__file__).resolve().parents[1]
DIGESTS = ROOT / "manifests" / "training_v1.digests.json"
LABELS = ROOT / "docs" / "results" / "training_v1.parquet"
FIGURE = ROOT / "docs" / "images" / "training_set.png"
SECONDS = 0.06  # of a frame
ACCEPTED = "accepted"
SIGNIFICANT = 0.05  # p after Holm's correction, below which a task is named
BINS = 12

Floats = NDArray[np.float64]
Row = tuple[str, ...]
Columns = Mapping[str, NDArray[np.object_]]


@cache
def digests() -> Digests:
    return schema.read(Digests, DIGESTS)


@cache
def labels() -> Columns:
    """Column of the labels' table -> its values, a row an attempt."""
    table = pq.read_table(LABELS).to_pydict()
    return {name: np.array(values, object) for name, values in table.items()}


def tasks() -> tuple[Row, Iterator[Row]]:
    """Table of tasks: how many attempts, what was rejected and why, and what an episode is."""
    head = ("task", "attempts", "rejected because", "length", "recovered", "sentences")
    return (*head, "objects", "MB", "CPU-s"), _tasks()


def _tasks() -> Iterator[Row]:
    table = labels()
    for name, one in digests().tasks.items():
        here = (table["task"] == name) & (table["outcome"] == ACCEPTED)
        lengths = table["frames"][here].astype(float) * SECONDS
        objects = {model for text in table["objects"][here] for model in str(text).split()}
        reasons = sorted(one.rejections.items(), key=lambda item: -item[1])
        number = len(one.episodes)
        yield (
            f"`{name}`",
            str(one.attempts),
            ", ".join(f"{count} {reason}" for reason, count in reasons),
            f"{np.median(lengths):.0f} s ({lengths.min():.0f} to {lengths.max():.0f})",
            str(int(table["recovered"][here].astype(bool).sum())),
            str(one.sentences),
            str(len(objects)),
            f"{one.bytes / number / 1e6:.1f}",
            f"{one.cpu_seconds / number:.1f}",
        )


def totals() -> tuple[Row, Iterator[Row]]:
    """Table of the whole set."""
    table, made = labels(), digests().tasks.values()
    accepted = table["outcome"] == ACCEPTED
    hours = table["frames"][accepted].astype(float).sum() * SECONDS / 3600
    objects = {model for text in table["objects"][accepted] for model in str(text).split()}
    facts = {
        "tasks": f"{len(made)}",
        "episodes": f"{accepted.sum():,}",
        "attempts": f"{len(accepted):,}",
        "frames of three cameras": f"{table['frames'][accepted].astype(int).sum():,}",
        "simulated time": f"{hours:.1f} h",
        "episodes with a recovery": f"{table['recovered'][accepted].astype(bool).sum():,}",
        "models of objects": f"{len(objects)}",
        "size": f"{sum(one.bytes for one in made) / 1e9:.0f} GB",
        "CPU time": f"{sum(one.cpu_seconds for one in made) / 3600:.1f} h",
        "drawn by": digests().driver,
    }
    return ("what", "how much"), ((what, much) for what, much in facts.items())


def numbers(key: str) -> Iterator[tuple[str, NDArray[np.bool_], Floats, NDArray[np.bool_]]]:
    """Each component of an attribute: column, rows in which it could act, values, accepted ones."""
    table = labels()
    for column in [key, *(f"{key}.{axis}" for axis in "xyz")]:
        if column in table:
            there = np.array([value is not None for value in table[column]])
            values = table[column][there].astype(float)
            yield column, there, values, (table["outcome"][there] == ACCEPTED)


def coverage() -> tuple[Row, Iterator[Row]]:
    """Table of attributes: distribution in attempts and in episodes, and where they differ."""
    head = ("attribute", "attempts", "range of attempts", "of episodes", "mean", "of episodes")
    return (*head, "tasks in which rejected values differ"), _coverage()


def _coverage() -> Iterator[Row]:
    bent = differing()
    for key in sorted(attributes()):
        for column, _, values, accepted in numbers(key):
            kept = values[accepted]
            where = [f"`{task}` ({to})" for name, task, to in bent if name == column]
            yield (
                f"`{column}`",
                f"{len(values):,}",
                f"{values.min():.3g} to {values.max():.3g}",
                f"{kept.min():.3g} to {kept.max():.3g}",
                f"{values.mean():.3g}",
                f"{kept.mean():.3g}",
                ", ".join(where) or "none",
            )


@cache
def differing() -> Sequence[tuple[str, str, str]]:
    """Column, task, and "low" or "high": which values are rejected more often than others.

    Mann-Whitney's test of rejected against accepted values of a task, with Holm's correction for
    all tasks and attributes.
    """
    task_of, tried = labels()["task"], list[tuple[float, str, str, str]]()
    for key in sorted(attributes()):
        for column, there, values, accepted in numbers(key):
            for task in dict.fromkeys(task_of):
                here = task_of[there] == task
                lost, kept = values[here & ~accepted], values[here & accepted]
                if not len(lost) or not len(kept) or np.ptp(values[here]) == 0:
                    continue
                p = float(scipy.stats.mannwhitneyu(lost, kept).pvalue)
                side = "low" if np.median(lost) < np.median(kept) else "high"
                tried.append((p, column, str(task), side))
    adjusted = holm([p for p, *_ in tried])
    return [(c, t, s) for (_, c, t, s), p in zip(tried, adjusted, strict=True) if p < SIGNIFICANT]


TABLES = {"training_totals": totals, "training_tasks": tasks, "training_coverage": coverage}


def draw(path: Path) -> None:
    """The distribution of every attribute, of attempts and of episodes."""
    import matplotlib

    matplotlib.use("Agg")
    from matplotlib import pyplot

    shown = [one for key in sorted(attributes()) for one in numbers(key)]
    figure, axes = pyplot.subplots(4, 4, figsize=(12, 9), layout="constrained")
    for ax, (name, _, values, accepted) in zip(axes.flat, shown, strict=False):
        edges = np.linspace(values.min(), values.max(), BINS + 1)
        ax.hist(values, edges, color="0.8", label="attempts")
        ax.hist(values[accepted], edges, color="C0", label="episodes")
        unit = attributes()[name.partition(".")[0]].unit
        ax.set_xlabel(name if unit == "1" else f"{name} [{unit}]", fontsize=9)
        ax.tick_params(labelsize=8)
        ax.locator_params(axis="x", nbins=5)
    for ax in axes.flat[len(shown) :]:
        ax.set_axis_off()
    axes.flat[-1].legend(*axes.flat[0].get_legend_handles_labels(), loc="center")
    figure.savefig(path, dpi=110)


if __name__ == "__main__":
    draw(FIGURE)
