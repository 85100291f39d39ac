"""How often the expert succeeds at each task, and what an episode costs; both as measured."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import cast

from rtphys.core import library
from rtphys.core.errors import BadFile

FILE = "rates"  # manifests/rates.yaml, written by scripts/rates.py
COSTS = "costs"  # manifests/costs.yaml, written by scripts/costs.py
PROTOCOL = "phys_random_all"  # under which costs are measured


@dataclass(frozen=True)
class Rate:
    """One task under one protocol."""

    seeds: int
    accepted: int

    def __add__(self, other: "Rate") -> "Rate":
        """Counts of both; `other` is of other seeds."""
        return Rate(self.seeds + other.seeds, self.accepted + other.accepted)

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
    try:
        rows = cast(Mapping[str, Mapping[str, Sequence[int]]], library.read_yaml(path))
        return {
            task: {protocol: Rate(*map(int, counts)) for protocol, counts in of_task.items()}
            for task, of_task in rows.items()
        }
    except (TypeError, ValueError, AttributeError) as problem:
        raise BadFile(path, f"not a table of rates ({problem})") from problem


@dataclass(frozen=True)
class Cost:
    """What an episode of a task costs, with three pictures of 320 x 240 a frame."""

    attempt: float  # [CPU-s] whether it is accepted or not
    pictures: float  # [CPU-s] of an accepted one: drawn, encoded, written
    megabytes: float  # of its files


def costs() -> dict[str, Cost]:
    """Task -> cost; tasks that were not measured are left out.

    Raises:
        BadFile: the file is not what scripts/costs.py writes.
    """
    path = library.names("manifests").get(COSTS)
    if path is None:
        return {}
    try:
        rows = cast(Mapping[str, Sequence[float]], library.read_yaml(path))
        return {task: Cost(*map(float, row)) for task, row in rows.items()}
    except (TypeError, ValueError) as problem:
        raise BadFile(path, f"not a table of costs ({problem})") from problem


def expected(episodes: Mapping[str, int]) -> tuple[float, float, list[str]]:
    """CPU-s and MB of so many episodes of each task, and the tasks that were not measured."""
    known, measured = rates(), costs()
    cpu = megabytes = 0.0
    for task, count in episodes.items():
        if (cost := measured.get(task)) is not None:
            rate = known.get(task, {}).get(PROTOCOL)
            share = rate.accepted / rate.seeds if rate is not None and rate.accepted else 1.0
            cpu += count * (cost.attempt / share + cost.pictures)
            megabytes += count * cost.megabytes
    return cpu, megabytes, [task for task in episodes if task not in measured]
