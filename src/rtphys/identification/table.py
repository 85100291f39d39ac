"""Episodes as a table: a row an episode, a column a feature, and the labels beside it."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from rtphys.core.poses import Array
from rtphys.identification.features import Places, group_of
from rtphys.physics.values import components

COMMON = 0.5  # share of the episodes that must have a feature
ALIKE = 0.95  # correlation, either way, beyond which two features of a group say the same


@dataclass(frozen=True)
class Sample:
    """One episode: its seed, its features, and the values of the attributes that act in it."""

    seed: int
    features: Mapping[str, float]
    labels: Mapping[str, float | tuple[float, ...]]


@dataclass(frozen=True, eq=False)
class Table:
    """Samples in the order of their seeds.

    A feature that fewer than half of the episodes have is left out; where another one lacks, it is
    the median of those that have it, which no label takes part in.
    """

    samples: Sequence[Sample]
    names: tuple[str, ...]  # of the columns
    values: Array  # (episodes, features)

    @property
    def groups(self) -> dict[str, Places]:
        """Group of signals -> indices of its columns."""
        of = np.array([group_of(name) for name in self.names])
        return {str(group): np.flatnonzero(of == group) for group in np.unique(of)}

    def labelled(self, key: str) -> tuple[Array, Array]:
        """Features (n, k) and values (n, components) of the episodes in which an attribute acts."""
        rows = [i for i, sample in enumerate(self.samples) if key in sample.labels]
        labels = [components(self.samples[i].labels[key]) for i in rows]
        return self.values[rows], np.array(labels, float).reshape(len(rows), -1)


def table_of(samples: Sequence[Sample]) -> Table:
    """The table of some episodes.

    Columns that never change are left out, and those that say the same as an earlier one of their
    group: trees learn as well from the rest, in a third of the time.
    """
    ordered = sorted(samples, key=lambda sample: sample.seed)
    known = sorted({name for sample in ordered for name in sample.features})
    raw = np.array([[s.features.get(name, np.nan) for name in known] for s in ordered], float)
    raw = raw.reshape(len(ordered), len(known))
    there = np.isfinite(raw)
    kept = there.mean(axis=0) >= COMMON if len(ordered) else np.zeros(len(known), bool)
    names, raw, there = (
        [n for n, keep in zip(known, kept, strict=True) if keep],
        raw[:, kept],
        there[:, kept],
    )
    filled = np.where(there, raw, np.nanmedian(raw, axis=0)) if len(names) else raw
    varies = np.ptp(filled, axis=0) > 0 if len(names) else np.zeros(0, bool)
    chosen = tuple(name for name, keep in zip(names, varies, strict=True) if keep)
    return _thinned(Table(ordered, chosen, filled[:, varies]))


def _thinned(table: Table) -> Table:
    """Of columns of a group that say the same, the first alone. No label takes part."""
    kept: list[int] = []
    for columns in table.groups.values():
        spread = table.values[:, columns] - table.values[:, columns].mean(axis=0)
        unit = spread / np.linalg.norm(spread, axis=0)
        open_ = np.ones(len(columns), bool)
        for i, column in enumerate(columns):
            if open_[i]:
                kept.append(int(column))
                open_ &= np.abs(unit[:, i] @ unit) <= ALIKE
    kept.sort()
    names = tuple(table.names[i] for i in kept)
    return Table(table.samples, names, table.values[:, kept])
