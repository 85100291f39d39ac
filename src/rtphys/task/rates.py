"""How often the expert succeeds at each task, as measured and kept with the library."""

from collections.abc import Mapping, Sequence
from dataclasses import astuple, dataclass
from typing import cast

from rtphys.core import library
from rtphys.core.errors import BadFile

FILE = "rates"  # manifests/rates.yaml, written by scripts/rates.py


@dataclass(frozen=True)
class Rate:
    """One task under one protocol."""

    seeds: int
    accepted: int
    replayed: int = 0  # accepted episodes whose recorded actions were replayed open-loop
    alone: int = 0  # of those, the successes

    def __add__(self, other: "Rate") -> "Rate":
        """Counts of both; `other` is of other seeds."""
        mine, theirs = astuple(self), astuple(other)
        return Rate(*(a + b for a, b in zip(mine, theirs, strict=True)))

    def __str__(self) -> str:
        return f"{100 * self.accepted / self.seeds:.0f} % of {self.seeds}"


def rates() -> dict[str, dict[str, Rate]]:
    """Task -> protocol -> rate; empty where nothing was measured.

    Raises:
        BadFile: the file is not what scripts/rates.py writes.
    """
    path = library.names("manifests").get(FILE)
    if path is None:
        return {}
    content = library.read_yaml(path)
    try:
        return {task: _protocols(rows) for task, rows in content.items()}
    except (TypeError, ValueError, AttributeError) as problem:
        raise BadFile(path, f"not a table of rates ({problem})") from problem


def _protocols(rows: object) -> dict[str, Rate]:
    if not isinstance(rows, dict):
        raise TypeError(f"{rows!r} is no mapping")
    counts_of = cast(Mapping[object, Sequence[int]], rows)
    return {str(protocol): Rate(*map(int, counts)) for protocol, counts in counts_of.items()}
