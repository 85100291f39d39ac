"""The summary of an evaluation: a function of its records and of the lists they were run on."""

from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import combinations

import numpy as np

from rtphys.data.episode import JSON
from rtphys.results.breaks import Break, breaks
from rtphys.results.instances import InstanceList
from rtphys.results.record import EpisodeRecord
from rtphys.results.statistics import Paired, Rate, paired

Key = tuple[str, str]  # protocol, task
Records = Mapping[Key, Sequence[EpisodeRecord]]


@dataclass(frozen=True)
class Counts:
    """Some rollouts and the slots of the lists that they came from."""

    slots: int  # seeds that certification tried
    infeasible: int  # of these, seeds that the expert could not do
    rollouts: int
    successes: int
    held: int

    @property
    def complete(self) -> bool:
        """Whether every feasible seed has been run."""
        return self.rollouts == self.slots - self.infeasible

    @property
    def of_feasible(self) -> Rate:
        return Rate(self.successes, self.rollouts)

    @property
    def of_slots(self) -> Rate | None:
        """None before the run is complete: an unknown part of the slots would be missing."""
        return Rate(self.successes, self.slots) if self.complete else None

    def to_json(self) -> dict[str, JSON]:
        return {
            "slots": self.slots,
            "infeasible": self.infeasible,
            "rollouts": self.rollouts,
            "complete": self.complete,
            "of_feasible": self.of_feasible.to_json(),
            "of_slots": self.of_slots.to_json() if self.of_slots else None,
            "held": Rate(self.held, self.rollouts).to_json(),
        }


@dataclass(frozen=True)
class TaskRow:
    """One task under one protocol."""

    protocol: str
    task: str
    counts: Counts
    steps: float | None  # mean number of actions of the successes
    reasons: Mapping[str, int]  # of the failures

    def to_json(self) -> dict[str, JSON]:
        own: dict[str, JSON] = {"protocol": self.protocol, "task": self.task}
        return own | self.counts.to_json() | {"steps": self.steps, "reasons": dict(self.reasons)}


@dataclass(frozen=True)
class ProtocolRow:
    """All tasks under one protocol."""

    protocol: str
    tasks: int
    counts: Counts
    mean_of_tasks: float | None  # of the tasks' rates among feasible seeds

    def to_json(self) -> dict[str, JSON]:
        own: dict[str, JSON] = {"protocol": self.protocol, "tasks": self.tasks}
        return own | self.counts.to_json() | {"mean_of_tasks": self.mean_of_tasks}


@dataclass(frozen=True)
class PairRow:
    """Two protocols on the seeds that both have."""

    first: str
    second: str
    outcome: Paired

    def to_json(self) -> dict[str, JSON]:
        return {"first": self.first, "second": self.second, **self.outcome.to_json()}


@dataclass(frozen=True)
class Summary:
    """All numbers of an evaluation."""

    tasks: tuple[TaskRow, ...]
    overall: tuple[ProtocolRow, ...]
    pairs: tuple[PairRow, ...]
    breaks: Mapping[str, Sequence[Break]]  # by protocol, the most telling attribute first

    def to_json(self) -> dict[str, JSON]:
        return {
            "tasks": [row.to_json() for row in self.tasks],
            "overall": [row.to_json() for row in self.overall],
            "pairs": [row.to_json() for row in self.pairs],
            "attributes": {key: [one.to_json() for one in v] for key, v in self.breaks.items()},
        }


def summarise(records: Records, lists: Mapping[Key, InstanceList]) -> Summary:
    """The summary does not depend on the order of records.

    Args:
        records: of every (protocol, task).
        lists: what they were run on, `InstanceList.first(episodes)`.
    """
    protocols = list(dict.fromkeys(protocol for protocol, _ in records))
    return Summary(
        tasks=tuple(_task(key, records[key], lists[key]) for key in records),
        overall=tuple(_protocol(name, records, lists) for name in protocols),
        pairs=tuple(PairRow(a, b, _pair(records, a, b)) for a, b in combinations(protocols, 2)),
        breaks={name: breaks(_of(records, name)) for name in protocols},
    )


def _counts(found: Sequence[EpisodeRecord], tried: Sequence[InstanceList]) -> Counts:
    slots = sum(one.attempts for one in tried)
    feasible = sum(len(one.feasible) for one in tried)
    wins, held = sum(r.success for r in found), sum(r.held for r in found)
    return Counts(slots, slots - feasible, len(found), wins, held)


def _task(key: Key, found: Sequence[EpisodeRecord], tried: InstanceList) -> TaskRow:
    steps = [record.steps for record in found if record.success]
    reasons = Counter(record.reason for record in found if not record.success)
    mean = float(np.mean(steps)) if steps else None
    return TaskRow(*key, _counts(found, [tried]), mean, dict(sorted(reasons.items())))


def _protocol(name: str, records: Records, lists: Mapping[Key, InstanceList]) -> ProtocolRow:
    keys = [key for key in records if key[0] == name]
    counts = _counts(_of(records, name), [lists[key] for key in keys])
    means = [np.mean([r.success for r in records[key]]) for key in keys if records[key]]
    return ProtocolRow(name, len(keys), counts, float(np.mean(means)) if means else None)


def _pair(records: Records, first: str, second: str) -> Paired:
    a, b = (
        {(r.task, r.seed): r.success for r in _of(records, protocol)}
        for protocol in (first, second)
    )
    return paired([(a[key], b[key]) for key in a if key in b])


def _of(records: Records, protocol: str) -> list[EpisodeRecord]:
    return [record for key, found in records.items() if key[0] == protocol for record in found]
