"""How well an estimator infers an attribute from features: R2 on seeds not learnt from."""

from collections import Counter, defaultdict
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from rtphys.analysis.estimators import TINY, Estimator
from rtphys.core.poses import Array
from rtphys.core.seeds import stream

STATISTICS = ("mean", "spread", "least", "most", "final", "change")  # of a signal in a stage
COMMON = 0.5  # share of the episodes that must have a feature
ALIKE = 0.95  # correlation, either way, beyond which two features of a group say the same
FOLDS = 5  # of the cross-validation; an episode's fold is its place among the seeds, modulo
MIN_EPISODES = 20  # below which nothing is scored
MIN_BEYOND = 8  # episodes on either side of the split by range
BOOTSTRAPS = 1000
LARGEST = 1e100  # prediction
LEVELS = (2.5, 97.5)  # [%] of the interval
SHUFFLES = 2  # fits with labels in another order, whose mean is reported

Indices = NDArray[np.intp]  # of episodes or features
Make = Callable[[], Estimator]  # an estimator that has learnt nothing


@dataclass(frozen=True)
class Sample:
    """One seed: the features of its episode, and the values of what acts and varies in it.

    Attributes:
        features: `stage/role/group/signal` -> its statistics, in the order of `STATISTICS`;
            `stage/duration` and `whole/side` -> a number.
        reason: why it gave no episode; empty if it did.
    """

    seed: int
    features: Mapping[str, float | list[float]] = field(default_factory=dict)
    labels: Mapping[str, float | list[float]] = field(default_factory=dict)
    reason: str = ""

    @property
    def columns(self) -> dict[str, float]:
        """Features by name, those of a signal with the name of the statistic at the end."""
        columns: dict[str, float] = {}
        for name, value in self.features.items():
            if isinstance(value, list):
                columns |= {f"{name}/{s}": x for s, x in zip(STATISTICS, value, strict=True)}
            else:
                columns[name] = value
        return columns


def group_of(column: str) -> str:
    """The group of signals that a column comes from; `timing` of durations and sides."""
    parts = column.split("/")
    return parts[2] if len(parts) > 3 else "timing"


@dataclass(frozen=True, eq=False)
class Table:
    """Samples in the order of their seeds, as a matrix: a row an episode, a column a feature."""

    samples: Sequence[Sample]
    names: tuple[str, ...]  # of the columns
    values: Array  # (episodes, features)

    @property
    def groups(self) -> dict[str, Indices]:
        """Group of signals -> indices of its columns."""
        of = np.array([group_of(name) for name in self.names])
        return {str(group): np.flatnonzero(of == group) for group in np.unique(of)}

    def labelled(self, key: str) -> tuple[Array, Array]:
        """Features (n, k) and values (n, components) of the episodes in which an attribute acts."""
        rows = [i for i, sample in enumerate(self.samples) if key in sample.labels]
        labels = [self.samples[i].labels[key] for i in rows]
        return self.values[rows], np.array(labels, float).reshape(len(rows), -1)


def table_of(samples: Sequence[Sample]) -> Table:
    """The table of the episodes among some samples; no label takes part in choosing its columns.

    A feature that fewer than half of the episodes have is left out; elsewhere a gap is the median.
    So are columns that never change, and those that say the same as an earlier one of their group:
    trees learn as well from the rest, in a third of the time.
    """
    ordered = sorted((s for s in samples if not s.reason), key=lambda sample: sample.seed)
    rows = [sample.columns for sample in ordered]
    counts = Counter(name for row in rows for name in row)
    names = sorted(name for name, count in counts.items() if count >= COMMON * len(rows))
    values = np.array([[row.get(name, np.nan) for name in names] for row in rows], float)
    if not names:
        return Table(ordered, (), np.empty((len(ordered), 0)))
    values = np.where(np.isnan(values), np.nanmedian(values, axis=0), values)
    spread, kept = values - values.mean(axis=0), defaultdict[str, list[int]](list)
    unit = spread / np.maximum(np.linalg.norm(spread, axis=0), TINY)
    for column in np.flatnonzero(np.ptp(values, axis=0) > 0):
        earlier = kept[group_of(names[column])]
        if not (np.abs(unit[:, earlier].T @ unit[:, column]) > ALIKE).any():
            earlier.append(int(column))
    chosen = sorted(column for columns in kept.values() for column in columns)
    return Table(ordered, tuple(names[column] for column in chosen), values[:, chosen])


class NotFinite(ValueError):
    """An estimator returned something else than one finite number an episode, of a size that has a
    square."""


@dataclass(frozen=True)
class Beyond:
    """Scores outside of the middle half of the range, which was learnt from."""

    r2: float
    interval: tuple[float, float]
    n: int  # episodes judged


@dataclass(frozen=True)
class Score:
    """How well one attribute can be inferred in one task."""

    r2: float  # out of fold, averaged over the components of a vector
    interval: tuple[float, float]  # at 95 %, by a bootstrap over seeds
    shuffled: float  # r2 with labels in another order; about zero or less
    importance: dict[str, float]  # group of signals -> what r2 loses where its columns are mixed up
    n: int  # episodes
    beyond: Beyond | None  # None where too few episodes are on one side, or those outside are equal


def score(table: Table, key: str, bounds: tuple[float, float], make: Make) -> Score:
    """Judges an estimator on one attribute of one task.

    `bounds`: the range from which each component of the attribute is drawn.

    Raises `NotFinite`: the estimator returned no finite numbers. Whatever else it raises passes.
    """
    X, Y = table.labelled(key)
    components = [_out_of_fold(X, y, make, table.groups) for y in Y.T]
    predicted = np.column_stack([whole for whole, _ in components])
    r2 = _r2(Y, predicted)
    importance = {
        group: r2 - _r2(Y, np.column_stack([mixed[group] for _, mixed in components]))
        for group in table.groups
    }
    orders = [stream(0, f"identify shuffle {k}").permutation(len(X)) for k in range(SHUFFLES)]
    shuffled = [
        _r2(Y[order], np.column_stack([_out_of_fold(X, y, make)[0] for y in Y[order].T]))
        for order in orders
    ]
    interval, beyond = _interval(Y, predicted), _beyond(X, Y, bounds, make)
    return Score(r2, interval, float(np.mean(shuffled)), importance, len(X), beyond)


def _out_of_fold(
    X: Array, y: Array, make: Make, groups: Mapping[str, Indices] | None = None
) -> tuple[Array, dict[str, Array]]:
    """Predictions (n,) out of fold, and the same with each group's columns mixed up."""
    fold = np.arange(len(X)) % FOLDS
    whole = np.empty(len(y))
    mixed = {group: np.empty(len(y)) for group in groups or {}}
    for k in range(FOLDS):
        learn, judge = np.flatnonzero(fold != k), np.flatnonzero(fold == k)
        (estimator := make()).fit(X[learn], y[learn])
        whole[judge] = _predicted(estimator, X[judge])
        order = stream(0, "identify importance").permutation(len(judge))
        for group, columns in (groups or {}).items():
            other = X[judge].copy()
            other[:, columns] = other[order][:, columns]
            mixed[group][judge] = _predicted(estimator, other)
    return whole, mixed


def _predicted(estimator: Estimator, X: Array) -> Array:
    values = np.asarray(estimator.predict(X), float)
    if values.shape != (len(X),):
        raise NotFinite(f"predict returned shape {values.shape}, not ({len(X)},)")
    if wrong := np.count_nonzero(~np.isfinite(values)):
        raise NotFinite(f"predict returned {wrong} numbers that are not finite")
    if (largest := float(np.abs(values).max(initial=0))) > LARGEST:
        raise NotFinite(f"predict returned {largest:g}, and more than {LARGEST:g} has no R2")
    return values


def _beyond(X: Array, Y: Array, bounds: tuple[float, float], make: Make) -> Beyond | None:
    """Learn from the middle half of each component's range, be judged outside of it."""
    quarter = (bounds[1] - bounds[0]) / 4
    scores, intervals, counts = [], [], []
    for y in Y.T:
        inside = (y >= bounds[0] + quarter) & (y <= bounds[1] - quarter)
        if min(inside.sum(), (~inside).sum()) < MIN_BEYOND or np.ptp(y[~inside]) == 0:
            return None
        (estimator := make()).fit(X[inside], y[inside])
        predicted = _predicted(estimator, X[~inside])
        pair = y[~inside][:, None], predicted[:, None]
        scores.append(_r2(*pair))
        intervals.append(_interval(*pair))
        counts.append(int((~inside).sum()))
    low, high = np.mean(intervals, axis=0)
    return Beyond(float(np.mean(scores)), (float(low), float(high)), min(counts))


def _r2(Y: Array, predicted: Array) -> float:
    """Share of the variance explained, averaged over the components (columns)."""
    left = ((Y - predicted) ** 2).sum(axis=0)
    return float(np.mean(1 - left / ((Y - Y.mean(axis=0)) ** 2).sum(axis=0)))


def _interval(Y: Array, predicted: Array) -> tuple[float, float]:
    """Draws in which all values of a component are equal have no R2, and count nothing."""
    draws = stream(0, "identify bootstrap").integers(len(Y), size=(BOOTSTRAPS, len(Y)))
    varied = [i for i in draws if np.ptp(Y[i], axis=0).all()]
    low, high = np.percentile([_r2(Y[i], predicted[i]) for i in varied], LEVELS)
    return float(low), float(high)
