"""The table of an evaluation: however narrow the terminal, no number is cut off."""

from io import StringIO

import pytest
from rich.console import Console

from rtphys.cli.evaluate_tables import rates_table
from rtphys.results.summary import Counts, ProtocolRow, Summary, TaskRow

COUNTS = Counts(slots=574, infeasible=74, rollouts=500, successes=445, held=333)
REASONS = {"step_limit": 44, "policy_error": 11}
TASK = "shake_bottle_horizontally"
SUMMARY = Summary(
    tasks=(TaskRow("phys_random_all", TASK, COUNTS, 100.0, REASONS),),
    overall=(ProtocolRow("phys_random_all", 2, COUNTS, 0.5),),
    pairs=(),
    breaks={},
)
TOLD = [
    "phys_random_all",
    TASK,
    "89 % [86, 91.5] 445/500",
    "77.5 % [73.9, 80.8] 445/574",
    "66.6 % [62.4, 70.6] 333/500",
    "step_limit 44, policy_error 11",
]


def cells(width: int) -> list[str]:
    """The text of each column below the head, its lines joined, without spaces."""
    console = Console(width=width, file=StringIO())
    console.print(rates_table(SUMMARY))
    assert isinstance(console.file, StringIO)
    rows = [line.split("│")[1:-1] for line in console.file.getvalue().splitlines() if "│" in line]
    return ["".join("".join(column).split()) for column in zip(*rows, strict=True)]


@pytest.mark.parametrize("width", [80, 100, 120, 140, 200])
def test_nothing_is_cut_off(width: int) -> None:
    total = ["phys_random_all", "all, mean 50 %", *TOLD[2:5], ""]
    told = [a + b for a, b in zip(TOLD, total, strict=True)]
    assert cells(width) == ["".join(text.split()) for text in told]
