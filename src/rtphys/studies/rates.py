"""How often the expert succeeds at each task, and what an episode costs; both as measured."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any, TypeVar

from rtphys.core import library
from rtphys.core.errors import BadFile
from rtphys.spec.collection import CollectionSpec
from rtphys.spec.protocol import load_protocol

T = TypeVar("T")

RATES = "rates"  # manifests/rates.yaml, written by scripts/rates.py
COSTS = "costs"  # manifests/costs.yaml, written by scripts/costs.py
PROTOCOL = "phys_random_all"  # under which costs are measured
# Of a protocol: CPU time and bytes of an episode as shares of those under `PROTOCOL`; one episode
# of each of six tasks, `rtphys bench`.
SHARES = {
    "clean": (0.85, 0.46),
    "official_random": (0.95, 0.95),
    "phys_random": (0.85, 0.49),
    PROTOCOL: (1.0, 1.0),
}
# Times its task's measured mean that the files of an episode take at most: 1.4 for its pictures,
# 1.7 where physics is held at what makes the expert slow.
MOST = 2.4


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
    """Task -> protocol -> rate. Raises `BadFile`: the file is not what scripts/rates.py writes."""
    return _table(RATES, lambda row: {name: Rate(*map(int, row[name])) for name in row})


@dataclass(frozen=True)
class Cost:
    """What an accepted episode of a task costs, with three pictures of 320 x 240 a frame."""

    cpu: float  # [CPU-s] with the attempts that failed before it
    megabytes: float  # of its files


def costs() -> dict[str, Cost]:
    """Task -> cost. Raises `BadFile`: the file is not what scripts/costs.py writes."""
    return _table(COSTS, lambda row: Cost(*map(float, row)))


def _table(name: str, read: Callable[[Any], T]) -> dict[str, T]:
    """Task -> its row of a file of manifests; without tasks that were not measured."""
    if (path := library.names("manifests").get(name)) is None:
        return {}
    try:
        return {task: read(row) for task, row in library.read_yaml(path).items()}
    except (TypeError, ValueError, AttributeError) as problem:
        raise BadFile(path, f"not a table of {name} ({problem})") from problem


def like(textured: bool, varied: bool) -> str:
    """The one of the four protocols in which an episode costs the same.

    Args:
        textured: whether table and wall are drawn.
        varied: whether the physics varies.
    """
    if textured:
        return PROTOCOL if varied else "official_random"
    return "phys_random" if varied else "clean"


def expected(specs: Sequence[CollectionSpec]) -> tuple[float, list[str]]:
    """CPU-s of the specs' episodes, without twins, and the tasks that were not measured."""
    measured, cpu = costs(), 0.0
    for spec in specs:
        if (cost := measured.get(spec.episode.task)) is not None:
            visual, varied = spec.episode.visual(), load_protocol(spec.episode.protocol).physics
            textured = visual is not None and visual.textures
            cpu += spec.episodes * SHARES[like(textured, varied)][0] * cost.cpu
    tasks = dict.fromkeys(spec.episode.task for spec in specs)
    return cpu, [task for task in tasks if task not in measured]
