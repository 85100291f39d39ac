"""One policy under one protocol, task by task."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from rtphys.core.errors import UnknownName
from rtphys.policies import short_name
from rtphys.results.folder import Results
from rtphys.results.statistics import Rate


@dataclass(frozen=True)
class Column:
    """What a table shows below one heading."""

    label: str
    protocol: str
    rates: Mapping[str, Rate]  # by task; among feasible seeds

    def mean(self, tasks: Sequence[str] | None = None) -> float | None:
        """Mean of the tasks' rates, each task counting once; None if nothing has been run."""
        values = [v for rate in self._of(tasks) if (v := rate.value) is not None]
        return float(np.mean(values)) if values else None

    def total(self, tasks: Sequence[str] | None = None) -> Rate:
        """All rollouts together."""
        found = self._of(tasks)
        return Rate(sum(r.successes for r in found), sum(r.trials for r in found))

    def _of(self, tasks: Sequence[str] | None) -> list[Rate]:
        return [rate for task, rate in self.rates.items() if tasks is None or task in tasks]


def labels(found: Sequence[Results]) -> list[str]:
    """What to call each evaluation: its policy, or its folder where two have the same."""
    policies = [short_name(results.policy) for results in found]
    return [
        name if policies.count(name) == 1 else results.path.name
        for name, results in zip(policies, found, strict=True)
    ]


def columns_of(found: Sequence[Results], protocol: str | None = None) -> list[Column]:
    """A column for each evaluation and protocol, protocols together.

    Raises:
        UnknownName: nobody was evaluated under `protocol`.
    """
    known = list(dict.fromkeys(name for results in found for name, _ in results.records))
    if protocol is not None and protocol not in known:
        raise UnknownName("protocol", protocol, known)
    names = labels(found)
    return [
        Column(label, wanted, _rates(results, wanted))
        for wanted in ([protocol] if protocol else known)
        for label, results in zip(names, found, strict=True)
        if any(name == wanted for name, _ in results.records)
    ]


def _rates(results: Results, protocol: str) -> dict[str, Rate]:
    return {
        task: Rate(sum(record.success for record in records), len(records))
        for (name, task), records in results.records.items()
        if name == protocol
    }
