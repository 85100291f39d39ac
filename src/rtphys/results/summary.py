"""Summary of an evaluation, computed from its records and the certified lists it was run on."""

import re
from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from itertools import combinations
from types import MappingProxyType

import numpy as np

from rtphys.core.errors import counted
from rtphys.core.untrusted import JSON
from rtphys.results.breaks import Break, breaks
from rtphys.results.evaluation import EpisodeRecord
from rtphys.results.instances import Fingerprint, InstanceList
from rtphys.results.statistics import Paired, Rate, paired
from rtphys.spec.protocol import VisualRandomization, load_protocol, protocol_names

CLAUSES = 3  # that a line names
NUMBER = r"[-+0-9.e]+%?"  # which differs between episodes of one cause
Key = tuple[str, str]  # protocol, task
Records = Mapping[Key, Sequence[EpisodeRecord]]


@dataclass(frozen=True)
class Counts:
    """Numbers of rollouts and successes, and of the certified seeds they were taken from."""

    feasible: int
    infeasible: int | None  # seeds that the expert could not solve; None: it did not try them here
    rollouts: int
    successes: int
    held: int  # successes that still held 0.5 s after the policy had stopped

    @staticmethod
    def of(records: Sequence[EpisodeRecord], lists: Sequence[InstanceList]) -> "Counts":
        feasible = sum(len(one.feasible) for one in lists)
        infeasible = sum(one.attempts for one in lists) - feasible
        known = not any(one.tried_under for one in lists)
        successes, held = sum(r.success for r in records), sum(r.held for r in records)
        return Counts(feasible, infeasible if known else None, len(records), successes, held)

    @property
    def tried(self) -> int | None:
        """Number of seeds that the expert tried under this protocol; None: it did not."""
        return None if self.infeasible is None else self.feasible + self.infeasible

    @property
    def complete(self) -> bool:
        """Whether every feasible seed has been run."""
        return self.rollouts == self.feasible

    @property
    def of_feasible(self) -> Rate:
        """Success rate among feasible seeds."""
        return Rate(self.successes, self.rollouts)

    @property
    def of_tried(self) -> Rate | None:
        """Success rate among all seeds tried, infeasible ones included.

        None until complete, and where nobody tried them under this protocol.
        """
        if self.tried is None or not self.complete:
            return None
        return Rate(self.successes, self.tried)

    def to_json(self) -> dict[str, JSON]:
        return {
            "tried": self.tried,
            "infeasible": self.infeasible,
            "rollouts": self.rollouts,
            "complete": self.complete,
            "of_feasible": self.of_feasible.to_json(),
            "of_tried": self.of_tried.to_json() if self.of_tried else None,
            "held": Rate(self.held, self.rollouts).to_json(),
        }


Spread = tuple[float, float, float]  # median, 90th percentile and largest


@dataclass(frozen=True)
class Loads:
    """What robots suffered in the successes: on one link that is no finger, in an arm joint."""

    force: Spread | None  # [N]; None without a success
    torque: Spread | None  # as a share of the motor's largest
    rough: int  # number of successes for which the expert would have been rejected

    @staticmethod
    def of(records: Sequence[EpisodeRecord]) -> "Loads":
        if not (wins := [record for record in records if record.success]):
            return Loads(None, None, 0)
        both = np.array([(record.force, record.torque) for record in wins])
        force, torque = np.quantile(both, (0.5, 0.9, 1.0), axis=0).T.tolist()
        return Loads((*force,), (*torque,), sum(record.rough for record in wins))

    def to_json(self) -> dict[str, JSON]:
        found: dict[str, JSON] = {"rough": self.rough}
        for name, spread in (("force", self.force), ("torque", self.torque)):
            found[name] = spread and dict(zip(("median", "p90", "max"), spread, strict=True))
        return found


@dataclass(frozen=True)
class TaskSummary:
    """Result of one task under one protocol."""

    protocol: str
    task: str
    counts: Counts
    loads: Loads
    steps: float | None  # mean number of actions of the successes
    reasons: Mapping[str, int]  # number of failures by reason
    clipped: Mapping[str, int] = field(default_factory=dict)  # actions, by number of an action
    language: str = ""  # the most frequent of its records, and in how many it stands


@dataclass(frozen=True)
class ProtocolSummary:
    """Result of all tasks under one protocol."""

    protocol: str
    tasks: int  # number of tasks
    counts: Counts
    loads: Loads
    mean_of_tasks: float | None  # mean of the tasks' success rates among feasible seeds


@dataclass(frozen=True)
class PairSummary:
    """Comparison of two protocols on the seeds that were evaluated under both."""

    first: str
    second: str
    outcome: Paired
    looks_differ: bool = False  # they vary the appearance differently, and the physics too

    @property
    def caution(self) -> str:
        """What the test cannot say, in one line; empty where physics or looks alone differ."""
        if not self.looks_differ:
            return ""
        return f"{self.first}, {self.second}: they differ in looks too, not in physics alone"


@dataclass(frozen=True)
class Summary:
    """All numbers of an evaluation."""

    tasks: tuple[TaskSummary, ...]
    overall: tuple[ProtocolSummary, ...]
    pairs: tuple[PairSummary, ...]
    breaks: Mapping[str, Sequence[Break]]  # by protocol; attributes by increasing p-value
    certified: bool = True  # false: the seeds are those of a dataset, which nobody has certified
    # Of stale lists alone: why they were stale, see `Fingerprint.changes`.
    changed: Mapping[Key, Sequence[str]] = field(default_factory=dict[Key, Sequence[str]])

    @property
    def stale(self) -> str:
        """That lists were stale when they were run, and why, in one line; empty if none was."""
        if not self.changed:
            return ""
        clauses = [*dict.fromkeys(clause for one in self.changed.values() for clause in one)]
        more = f"; {len(clauses) - CLAUSES} more in summary.json" if len(clauses) > CLAUSES else ""
        return (
            f"{len(self.changed)} of {counted(len(self.tasks), 'lists')} had another certification "
            f"fingerprint when they were run: {'; '.join(clauses[:CLAUSES])}{more}"
        )

    def to_json(self) -> dict[str, JSON]:
        """Each row flat: its counts, its loads or its outcome beside its names."""

        def flat(row: TaskSummary | ProtocolSummary | PairSummary) -> dict[str, JSON]:
            found: dict[str, JSON] = {}
            for name, value in vars(row).items():
                parts = isinstance(value, Counts | Loads | Paired)
                found |= value.to_json() if parts else {name: value}
            return found

        changed = [
            {"protocol": protocol, "task": task, "clauses": list(clauses)}
            for (protocol, task), clauses in self.changed.items()
        ]
        return {
            "certified": self.certified,
            **({"changed_since_certified": changed} if changed else {}),
            "tasks": [*map(flat, self.tasks)],
            "overall": [*map(flat, self.overall)],
            "pairs": [*map(flat, self.pairs)],
            "attributes": {
                protocol: [effect.to_json() for effect in effects]
                for protocol, effects in self.breaks.items()
            },
        }


def summarise(
    records: Records,
    lists: Mapping[Key, InstanceList],
    fingerprints: Mapping[Key, Fingerprint] = MappingProxyType({}),
) -> Summary:
    """Summarises an evaluation; the order of records within a task does not matter.

    Args:
        records: by (protocol, task).
        lists: the certified seeds they were run on, `InstanceList.first(episodes)`, same keys.
        fingerprints: as they were where the policy was run, so far as they are known.
    """
    tasks = [_task(key, known, lists[key]) for key, known in records.items()]
    under, overall, pairs = dict[str, list[EpisodeRecord]](), [], []
    for name in dict.fromkeys(protocol for protocol, _ in records):
        keys = [key for key in records if key[0] == name]
        under[name] = [record for key in keys for record in records[key]]
        counts = Counts.of(under[name], [lists[key] for key in keys])
        means = [np.mean([r.success for r in records[key]]) for key in keys if records[key]]
        mean = float(np.mean(means)) if means else None
        overall.append(ProtocolSummary(name, len(keys), counts, Loads.of(under[name]), mean))
    for first, second in combinations(under, 2):
        other = {(r.task, r.seed): r.success for r in under[second]}
        both = [
            (r.success, other[r.task, r.seed]) for r in under[first] if (r.task, r.seed) in other
        ]
        pairs.append(PairSummary(first, second, paired(both), _looks_differ(first, second)))
    effects = {name: breaks(played) for name, played in under.items()}
    known = {key: lists[key].fingerprint.changes(now) for key, now in fingerprints.items()}
    changed = {key: clauses for key, clauses in known.items() if clauses}
    certified = all(lists[key].certified for key in records)
    return Summary(tuple(tasks), tuple(overall), tuple(pairs), effects, certified, changed)


def _looks_differ(*names: str) -> bool:
    """Whether two protocols differ in physics and in looks; false for one that is not known here.

    The look may leave the table's height to the physics, which is no difference.
    """
    if not set(names) <= set(protocol_names()):
        return False
    both = [load_protocol(name) for name in names]
    looks = {replace(one.visual or VisualRandomization(), table_drop=0.0) for one in both}
    physics = {(one.physics, one.only, one.width) for one in both}
    return len(looks) > 1 and len(physics) > 1


def _task(key: Key, records: Sequence[EpisodeRecord], instances: InstanceList) -> TaskSummary:
    steps = [record.steps for record in records if record.success]
    reasons = Counter(record.reason for record in records if not record.success)
    clipped = sum((Counter(record.clipped) for record in records), Counter[str]())
    causes = Counter(re.sub(NUMBER, "", r.language) for r in records if r.language)
    language = ""
    if causes:
        ((kind, times),) = causes.most_common(1)
        first = next(r.language for r in records if re.sub(NUMBER, "", r.language) == kind)
        language = f"{first} ({times} of {len(records)} episodes)"
    return TaskSummary(
        *key,
        Counts.of(records, [instances]),
        Loads.of(records),
        float(np.mean(steps)) if steps else None,
        dict(sorted(reasons.items())),
        dict(clipped),
        language,
    )
