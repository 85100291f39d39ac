"""Tables of docs/visual_policy.md, from the files that `experiment.py` of the example writes."""

import json
from collections.abc import Iterator, Mapping
from functools import cache
from pathlib import Path
from typing import Any

FOLDER = Path(__file__).resolve().parents[1] / "docs" / "visual_policy"
TRAINING = ("clean", "phys_random", "phys_random_labels", "official_random", "phys_random_all")
TESTS = {
    "physics": ("clean", "phys_random_25", "phys_random_50", "phys_random"),
    "looks": ("clean", "phys_random", "official_random", "phys_random_all"),
}
SIGNIFICANT = 0.05  # p after Holm's correction, below which an attribute is named

Rows = Iterator[tuple[str, ...]]
Cells = Mapping[tuple[str, str], Mapping[str, Any]]  # training set, test -> what was found


@cache
def matrices() -> dict[str, dict[str, Any]]:
    """The experiment's files by task."""
    return {path.stem: json.loads(path.read_text()) for path in sorted(FOLDER.glob("*.json"))}


def cells_of(task: str) -> Cells:
    """Cells of a task by training set and test."""
    return {(cell["train"], cell["test"]): cell for cell in matrices()[task]["cells"]}


def successes(block: str) -> Rows:
    """Success of each task and training set under the tests of a block, with intervals."""
    for task in matrices():
        cells = cells_of(task)
        for train in TRAINING:
            found = [cells.get((train, test)) for test in TESTS[block]]
            if sum(cell is not None for cell in found) > 1:
                yield f"`{task}`", f"`{train}`", *map(_rate, found)


def falls() -> Rows:
    """What `phys_random` costs a policy that was trained on `clean`, and what training wins back.

    Counts of seeds that only one of two cells solves, with McNemar's p.
    """
    for task, matrix in matrices().items():
        pairs = {(tuple(p["first"]), tuple(p["second"])): p for p in matrix["pairs"]}
        asked = (
            (("clean", "clean"), ("clean", "phys_random")),
            (("clean", "phys_random"), ("phys_random", "phys_random")),
            (("phys_random", "phys_random"), ("phys_random_labels", "phys_random")),
        )
        shown = [pairs.get(pair) for pair in asked]
        if any(shown):
            yield f"`{task}`", *(_pair(pair) for pair in shown)


def breaking() -> Rows:
    """Attributes that matter under `phys_random`, for each task and training set."""
    for task in matrices():
        cells = cells_of(task)
        for train in TRAINING[:3]:
            if cell := cells.get((train, "phys_random")):
                named = [a for a in cell["attributes"] if a["p_holm"] < SIGNIFICANT]
                said = ", ".join(_effect(a) for a in named) or "none"
                yield f"`{task}`", f"`{train}`", said


def _rate(cell: Mapping[str, Any] | None) -> str:
    if cell is None:
        return "-"
    low, high = (f"{100 * cell[key]:.0f}" for key in ("low", "high"))
    return f"{100 * cell['rate']:.0f} % [{low}, {high}]"


def _pair(pair: Mapping[str, Any] | None) -> str:
    if pair is None:
        return "-"
    return f"{pair['only_first']}, {pair['only_second']} of {pair['trials']}, p = {pair['p']:.1g}"


def _effect(found: Mapping[str, Any]) -> str:
    way = "high" if found["log_odds"] < 0 else "low"
    return f"{way} `{found['attribute']}` (p = {found['p_holm']:.1g})"
