"""Comparison of evaluations: success by task, paired outcomes on common seeds, ranks of tasks.

The rates of the RoboTwin-Phys paper (arXiv 2609.26292, Tables 1 and 3) can stand beside them. Two
things to know before citing these:

* Table 3 prints `place_burger_fries` twice, with the same numbers, so it has 51 rows for 50 tasks.
  Here it occurs once.
* Two of its printed averages are not the means of its 50 tasks: Motus has 39.56 (printed 39.60),
  pi0.5 31.50 (printed 31.60, also in Table 1). The other three agree.
"""

import csv
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import asdict, dataclass, field
from importlib.resources import files as resources
from itertools import combinations
from pathlib import Path

import numpy as np
import scipy

from rtphys.core.errors import UnknownName, counted
from rtphys.results.evaluation import EpisodeRecord, Results
from rtphys.results.statistics import Paired, Rate, paired

MIN_RANKED = 3  # tasks; the ranks of two agree or disagree in full, whatever they are
ROLLOUTS = 100  # of the paper, per task
PAPER_PROTOCOLS = {
    "clean": "clean",
    "official_random": "official_random",
    "physical_random": "phys_random_all",
}
"""The paper's name of a protocol -> ours."""


@dataclass(frozen=True)
class Column:
    """Success rates of one policy under one protocol, by task: a column of a comparison table."""

    label: str
    protocol: str
    rates: Mapping[str, Rate]  # by task; among feasible seeds
    unfinished: Mapping[str, tuple[int, int]] = field(default_factory=dict[str, tuple[int, int]])
    """Task -> episodes that were run, and of how many, where that is not all."""

    def mean(self, tasks: Sequence[str]) -> float | None:
        """Mean of the tasks' rates, each task counting once; None if nothing has been run."""
        rates = [self.rates[task].value for task in tasks if task in self.rates]
        values = [value for value in rates if value is not None]
        return float(np.mean(values)) if values else None

    def total(self, tasks: Sequence[str]) -> Rate:
        """Success rate over all rollouts of the tasks together."""
        rates = [self.rates[task] for task in tasks if task in self.rates]
        return Rate(sum(r.successes for r in rates), sum(r.trials for r in rates))


@dataclass(frozen=True)
class PairedComparison:
    """Outcomes of two evaluations on the instances that both were run on, under one protocol."""

    first: str
    second: str
    protocol: str
    outcome: Paired
    unpaired: tuple[str, ...]  # common seeds that are not the same instance, and why


@dataclass(frozen=True)
class RankAgreement:
    """How alike two policies rank the tasks, from the easiest to the hardest, under a protocol."""

    first: str
    second: str
    protocol: str
    tasks: int  # that both were run on
    rho: float | None  # Spearman's rank correlation; None: one of them has all tasks equal
    p: float | None  # of a rho at least as far from 0 among unrelated ranks


@dataclass(frozen=True)
class Comparison:
    """Several evaluations side by side, the paper's methods last where they were asked for."""

    columns: Sequence[Column]
    tasks: Sequence[str]
    pairs: Sequence[PairedComparison]
    ranks: Sequence[RankAgreement]

    def to_json(self) -> dict[str, object]:
        """Plain values, as `rtphys compare` prints them."""
        columns = [
            {
                "policy": column.label,
                "protocol": column.protocol,
                "mean": column.mean(self.tasks),
                "tasks": {t: column.rates[t].to_json() for t in self.tasks if t in column.rates},
                "unfinished": dict(column.unfinished),
            }
            for column in self.columns
        ]
        pairs = [
            {**{k: v for k, v in vars(p).items() if k != "outcome"}, **p.outcome.to_json()}
            for p in self.pairs
        ]
        ranks = [asdict(rank) for rank in self.ranks]
        return {"columns": columns, "same_seeds": pairs, "rank_agreement": ranks}


def compare(evaluations: Sequence[Results], protocol: str | None, paper: bool) -> Comparison:
    """Compare evaluations under one protocol, or under each that one of them has.

    Raises `UnknownName`: nothing was evaluated under `protocol`. Without evaluations the paper's
    methods must have been, task by task.
    """
    columns, of_paper = columns_of(evaluations), paper_columns() if paper else []
    known = dict.fromkeys(column.protocol for column in columns or of_paper)
    if protocol is not None and protocol not in known:
        raise UnknownName("evaluated protocol", protocol, known)
    columns, of_paper = (
        [column for column in some if protocol in (None, column.protocol)]
        for some in (columns, of_paper)
    )
    tasks = list(dict.fromkeys(task for column in columns for task in column.rates))
    tasks = tasks or sorted(task for column in of_paper[:1] for task in column.rates)
    columns += of_paper
    pairs = [p for p in paired_comparisons(evaluations) if protocol in (None, p.protocol)]
    return Comparison(columns, tasks, pairs, rank_agreements(columns))


def columns_of(evaluations: Sequence[Results]) -> list[Column]:
    """A column per evaluation and protocol, ordered by protocol."""
    columns = []
    for chosen in dict.fromkeys(name for results in evaluations for name, _ in results.records):
        for label, results in zip(_labels(evaluations), evaluations, strict=True):
            rates, unfinished = dict[str, Rate](), dict[str, tuple[int, int]]()
            for (name, task), rows in results.records.items():
                if name == chosen:
                    rates[task] = Rate(sum(record.success for record in rows), len(rows))
                    if counts := results.unfinished(chosen, task):
                        unfinished[task] = counts
            if rates:
                columns.append(Column(label, chosen, rates, unfinished))
    return columns


def paired_comparisons(evaluations: Sequence[Results]) -> list[PairedComparison]:
    """Compares every two evaluations under every protocol on their common instances.

    A seed is the same instance in both only where robot, code, assets, domain and look are the
    same, and the physics that was drawn. Seeds that only one was run on are left out; so are those
    that are another instance in each, which `unpaired` tells.
    """
    comparisons = []
    labelled = zip(_labels(evaluations), evaluations, strict=True)
    for (first, results), (second, other) in combinations(labelled, 2):
        for protocol in dict.fromkeys(name for name, _ in results.records):
            pairs, unpaired = list[tuple[bool, bool]](), list[str]()
            for task in (task for name, task in results.records if name == protocol):
                if (protocol, task) in other.records:
                    same, reason = _same_instances(results, other, protocol, task)
                    pairs += [(a.success, b.success) for a, b in same]
                    unpaired += [f"{task}: {reason}"] if reason else []
            if pairs or unpaired:
                outcome, apart = paired(pairs), tuple(unpaired)
                comparisons.append(PairedComparison(first, second, protocol, outcome, apart))
    return comparisons


def _same_instances(
    first: Results, second: Results, protocol: str, task: str
) -> tuple[list[tuple[EpisodeRecord, EpisodeRecord]], str]:
    """Records of the same instance, and why other seeds that both have are none."""
    there = {record.seed: record for record in second.records[protocol, task]}
    common = [(a, there[a.seed]) for a in first.records[protocol, task] if a.seed in there]
    ours, theirs = first.ground(protocol, task), second.ground(protocol, task)
    if common and (clause := _differing(ours, theirs)):
        return [], f"{counted(len(common), 'common seeds')}: other instances ({clause})"
    same = [(a, b) for a, b in common if not _differing(a.physics, b.physics)]
    other = [(a, b) for a, b in common if _differing(a.physics, b.physics)]
    if not other:
        return same, ""
    (a, b), number = other[0], counted(len(other), "common seeds")
    clause = f"seed {a.seed}: {_differing(a.physics, b.physics)}"
    return same, f"{number}: other physics ({clause})"


def _differing(first: Mapping[str, object], second: Mapping[str, object]) -> str:
    """What both state and state differently."""
    keys = [key for key in first if key in second and first[key] != second[key]]
    return "; ".join(f"{key} {first[key]} and {second[key]}" for key in keys)


def unfinished(columns: Sequence[Column]) -> list[str]:
    """A clause for each column of which not all episodes were run."""
    clauses = []
    for column in columns:
        begun = {task: counts for task, counts in column.unfinished.items() if counts[0]}
        parts = [
            f"{done} of {counted(planned, 'episodes')} of {task}"
            for task, (done, planned) in begun.items()
        ]
        if empty := len(column.unfinished) - len(begun):
            noun = "more tasks" if begun else "tasks"
            parts.append(f"none of {counted(empty, noun)}")
        clauses += [f"{column.label}, {column.protocol}: {', '.join(parts)}"] if parts else []
    return clauses


def rank_agreements(columns: Sequence[Column]) -> list[RankAgreement]:
    """Every two columns of the same protocol that share at least three tasks."""
    agreements = []
    for first, second in combinations(columns, 2):
        there = second.rates
        both = [(rate.value, there[t].value) for t, rate in first.rates.items() if t in there]
        ranked = [pair for pair in both if None not in pair]
        if first.protocol != second.protocol or len(ranked) < MIN_RANKED:
            continue
        rho, p = None, None
        if all(len(set(values)) > 1 for values in zip(*ranked, strict=True)):  # scipy returns NaN
            rho, p = map(float, np.asarray(scipy.stats.spearmanr(ranked)))
        names = (first.label, second.label, first.protocol)
        agreements.append(RankAgreement(*names, len(ranked), rho, p))
    return agreements


def _labels(evaluations: Sequence[Results]) -> list[str]:
    """Of each evaluation its policy with its options; the robot too, where they have several."""
    several = len({results.robot for results in evaluations}) > 1
    names = [results.spec.short_actor + f" ({results.robot})" * several for results in evaluations]
    return told_apart(names, [results.path for results in evaluations])


def told_apart(names: Sequence[str], paths: Iterable[Path]) -> list[str]:
    """Each name, and its path where two have it."""
    return [
        name if names.count(name) == 1 else f"{name} ({path})"
        for name, path in zip(names, paths, strict=True)
    ]


def paper_columns() -> list[Column]:
    """Table 3 of the paper: five methods on 50 tasks under Physical Random, a column each."""
    rows = _paper_table("paper_table3.csv")
    return [
        Column(
            f"{method} (paper)",
            PAPER_PROTOCOLS["physical_random"],
            {row["task"]: Rate(int(row[method]), ROLLOUTS) for row in rows},
        )
        for method in rows[0]
        if method != "task"
    ]


def paper_means() -> dict[str, dict[str, float]]:
    """Table 1 of the paper as printed: method -> our protocol -> mean success [%]."""
    return {
        row["method"]: {ours: float(row[theirs]) for theirs, ours in PAPER_PROTOCOLS.items()}
        for row in _paper_table("paper_table1.csv")
    }


def _paper_table(name: str) -> list[dict[str, str]]:
    text = (resources("rtphys.analysis") / name).read_text(encoding="utf-8")
    return list(csv.DictReader(text.splitlines()))
