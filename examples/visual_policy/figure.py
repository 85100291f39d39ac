"""Draw an experiment, its folder or the file that is published: python figure.py run/matrix out.png

One panel a task: success under each test with 95 % intervals, one colour a training protocol.
"""

import json
import sys
from collections.abc import Iterable, Sequence
from pathlib import Path

import matplotlib

matplotlib.use("Agg")

import matplotlib.pyplot as plt
import numpy as np

from rtphys.results.statistics import Rate

# Tests in the order of the figure; others follow.
TESTS = ("clean", "phys_random_dynamics", "phys_random_fixed_height", "phys_random")
SHIFT = 0.12  # between the points of two training protocols

Matrices = dict[str, list[dict]]  # task -> cells


def read(path: Path) -> Matrices:
    """Cells by name of the task, of a folder with a file a task, or of a file with all tasks."""
    if path.is_dir():
        tasks = {p.stem: json.loads(p.read_text()) for p in sorted(path.glob("*.json"))}
    else:
        tasks = json.loads(path.read_text())
    return {task: found["cells"] for task, found in tasks.items()}


def draw(found: Matrices, out: Path) -> None:
    """Draw all tasks beside each other."""
    tests = _tests(cell["test"] for cells in found.values() for cell in cells)
    trained = sorted({cell["train"] for cells in found.values() for cell in cells})
    size = (0.9 * len(tests) * len(found) + 1, 3.2)
    figure, axes = plt.subplots(1, len(found), figsize=size, squeeze=False, layout="constrained")
    for axis, (task, cells) in zip(axes.flat, found.items(), strict=True):
        for place, train in enumerate(trained):
            shift = SHIFT * (place - (len(trained) - 1) / 2)
            _points(axis, tests, [c for c in cells if c["train"] == train], shift, f"C{place}")
        axis.set_title(task, fontsize=10)
        axis.set_xticks(range(len(tests)), [_wrapped(test) for test in tests], fontsize=8)
        axis.set_ylim(-3, 103)
        axis.grid(axis="y", alpha=0.3)
        axis.spines[["top", "right"]].set_visible(False)
    axes[0, 0].set_ylabel("success [%]")
    marks = [plt.Line2D([], [], color=f"C{n}", marker="o") for n in range(len(trained))]
    names = [f"trained on {train}" for train in trained]
    figure.legend(marks, names, loc="outside lower center", ncols=2, frameon=False, fontsize=9)
    figure.savefig(out, dpi=120, metadata={"Software": None})
    plt.close(figure)


def _tests(names: Iterable[str]) -> list[str]:
    found = set(names)
    return [*(test for test in TESTS if test in found), *sorted(found.difference(TESTS))]


def _wrapped(protocol: str) -> str:
    return protocol.replace("phys_random_", "phys_random_\n").replace("fixed_", "fixed_\n")


def _points(
    axis: plt.Axes, tests: Sequence[str], cells: Sequence[dict], shift: float, colour: str
) -> None:
    """Rates of one training protocol with their intervals."""
    for cell in cells:
        rate = Rate(len(cell["solved"]), len(cell["solved"]) + len(cell["failed"]))
        value, (low, high) = rate.value or 0.0, rate.interval
        x, reach = tests.index(cell["test"]) + shift, np.array([[value - low], [high - value]])
        style = {"fmt": "o", "color": colour, "markersize": 5, "capsize": 3, "linewidth": 1}
        axis.errorbar(x, 100 * value, yerr=100 * reach, **style)


if __name__ == "__main__":
    draw(read(Path(sys.argv[1])), Path(sys.argv[2]))
