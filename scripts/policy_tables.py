"""Tables of docs/visual_policy.md, from the results of the example's `experiment.py`."""

from collections.abc import Callable, Iterator, Mapping, Sequence
from functools import cache
from typing import Any

import results
from rtphys.results.statistics import Paired, Rate, paired

TRAINING = ("clean", "phys_random")
TESTS = ("clean", "phys_random_dynamics", "phys_random_fixed_height", "phys_random")
SIGNIFICANT = 0.05  # p after Holm's correction, below which an attribute is named

Key = tuple[str, str]  # of a cell: training set and test
Cell = Mapping[str, Any]  # the outcomes of one test
Row = tuple[str, ...]
Table = tuple[Row, Iterator[Row]]  # head and rows


# Title of a column -> the two cells that it compares.
PAIRS: dict[str, tuple[Key, Key]] = {
    "trained on `clean`: `clean`, `phys_random`": (("clean", "clean"), ("clean", "phys_random")),
    "trained on `clean`: `clean`, `phys_random_dynamics`": (
        ("clean", "clean"),
        ("clean", "phys_random_dynamics"),
    ),
    "tested on `phys_random`: trained on `clean`, `phys_random`": (
        ("clean", "phys_random"),
        ("phys_random", "phys_random"),
    ),
}


@cache
def _matrices() -> dict[str, dict[Key, Cell]]:
    """Task -> cells of the experiment."""
    return {
        task: {(cell["train"], cell["test"]): cell for cell in matrix["cells"]}
        for task, matrix in results.load("visual_policy").items()
    }


def _by_test(tests: Sequence[str], shown: Callable[[Cell], str]) -> Table:
    """A row a task and training protocol, a column a test."""
    rows = (
        (f"`{task}`", f"`{train}`", *(shown(cells[train, test]) for test in tests))
        for task, cells in _matrices().items()
        for train in TRAINING
    )
    return ("task", "trained on", *(f"`{test}`" for test in tests)), rows


def _pairs() -> Table:
    """Counts of seeds that only one of two cells solves, with McNemar's p."""
    rows = (
        (f"`{task}`", *(_pair(cells[first], cells[second]) for first, second in PAIRS.values()))
        for task, cells in _matrices().items()
    )
    return ("task", *PAIRS), rows


def _named(cell: Cell) -> str:
    """Attributes at which a policy fails more often."""
    named = [
        f"{'high' if of['log_odds'] < 0 else 'low'} `{of['attribute']}` (p = {of['p_holm']:.1g})"
        for of in cell["attributes"]
        if of["p_holm"] < SIGNIFICANT
    ]
    return ", ".join(named) or "none"


def rate(cell: Cell) -> Rate:
    """Success rate of a cell."""
    return Rate(len(cell["solved"]), len(cell["solved"]) + len(cell["failed"]))


def _rate(cell: Cell) -> str:
    success = rate(cell)
    low, high = (f"{100 * bound:.0f}" for bound in success.interval)
    return f"{100 * (success.value or 0):.0f} % [{low}, {high}]"


def _pair(first: Cell, second: Cell) -> str:
    outcome = _between(first, second)
    counts = f"{outcome.only_first}, {outcome.only_second} of {outcome.trials}"
    return f"{counts}, p = {outcome.p:.1g}"


def _between(first: Cell, second: Cell) -> Paired:
    """McNemar's test of two cells on the seeds that they share."""
    a, b = (
        dict.fromkeys(cell["solved"], True) | dict.fromkeys(cell["failed"], False)
        for cell in (first, second)
    )
    return paired([(a[seed], b[seed]) for seed in sorted(a.keys() & b.keys())])


TABLES: dict[str, Callable[[], Table]] = {
    "policy_successes": lambda: _by_test(TESTS, _rate),
    "policy_pairs": _pairs,
    "policy_breaking": lambda: _by_test(TESTS[1:], _named),
}
"""Name of a table -> its head and rows."""
