"""Compares accepted with attempted values of each attribute: what feasibility filtered out."""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.stats import ks_2samp

from rtphys.core.poses import Array
from rtphys.data.attempts import Accepted
from rtphys.data.dataset import Dataset, flattened
from rtphys.physics.attribute import attribute, is_attribute

FIFTHS = 5
UNLIKELY = 0.01  # p below which a difference is reported
MIN_ATTEMPTS = 5  # accepted or rejected attempts below which nothing is reported


@dataclass(frozen=True, eq=False)
class Selection:
    """Values of one attribute, or of one of its components, in all attempts of a dataset."""

    key: str
    unit: str
    attempted: Array  # (n,) in the attribute's own unit
    accepted: NDArray[np.bool_]  # (n,)

    @property
    def distance(self) -> float:
        """Kolmogorov-Smirnov distance between accepted and attempted values."""
        if not self.accepted.any():
            return 1.0
        return float(np.asarray(ks_2samp(self.attempted[self.accepted], self.attempted))[0])

    @property
    def p(self) -> float:
        """p-value of the hypothesis that acceptance does not depend on this attribute.

        A two-sample test of accepted against rejected values. Accepted and attempted values are
        no independent samples, which the test needs, since they share members.
        """
        kept, cut = self.attempted[self.accepted], self.attempted[~self.accepted]
        if min(len(kept), len(cut)) < MIN_ATTEMPTS:
            return 1.0
        return float(np.asarray(ks_2samp(kept, cut))[1])

    @property
    def rates(self) -> tuple[Array, Array]:
        """Edges (6,) and accepted shares (5,) of five bins with equally many attempts."""
        order = np.argsort(self.attempted, kind="stable")
        parts = np.array_split(order, FIFTHS)
        edges = [self.attempted[part[0]] for part in parts if len(part)]
        edges.append(self.attempted[order[-1]])
        return np.array(edges), np.array([self.accepted[p].mean() for p in parts if len(p)])

    @property
    def sentence(self) -> str:
        """The result in one sentence."""
        kept, n = int(self.accepted.sum()), len(self.accepted)
        if not kept:
            return "nothing was accepted"
        if min(kept, n - kept) < MIN_ATTEMPTS:
            fewer = "rejections" if n - kept < MIN_ATTEMPTS else "acceptances"
            return f"too few {fewer} to tell"
        if self.p >= UNLIKELY:
            return "no cut that shows"
        edges, rates = self.rates
        worst = int(np.argmin(rates))
        rest = np.delete(rates, worst).mean()
        low, high = edges[worst], edges[worst + 1]
        where = {0: "low", len(rates) - 1: "high"}.get(worst, "middle")
        return (
            f"{where} values were cut: of {low:.3g} to {high:.3g} {self.unit} "
            f"{100 * rates[worst]:.0f} % passed, elsewhere {100 * rest:.0f} %"
        )


def selections(attempts: Iterable[tuple[Mapping[str, object], bool]]) -> list[Selection]:
    """One `Selection` for each scalar, and each component of a vector, that varies.

    Args:
        attempts: (values by attribute, accepted) of every attempt whose physics was drawn.
    """
    found: dict[str, list[tuple[float, bool]]] = {}
    for values, accepted in attempts:
        for name, number in flattened(values).items():
            if is_attribute(name.partition(".")[0]):
                found.setdefault(name, []).append((number, accepted))
    varying = []
    for name, rows in sorted(found.items()):
        attempted, accepted = np.array(rows, float).T
        if np.ptp(attempted) > 0:
            unit = attribute(name.partition(".")[0]).unit
            varying.append(Selection(name, unit, attempted, accepted > 0))
    return varying


def selections_by_task_dataset(dataset: Dataset) -> dict[str, list[Selection]]:
    """Task dataset -> selection of each attribute there; "all" is all task datasets together.

    Raises `BadFile`: a ledger, the only record of attempts, is missing or damaged.
    """
    found: dict[str, list[Selection]] = {}
    everything: list[tuple[Mapping[str, object], bool]] = []
    for name, entry in dataset.manifest.task_datasets.items():
        rows = entry.rows(dataset.path)
        # An attempt that was rejected before its physics was drawn has none.
        own = [(row.physics, isinstance(row, Accepted)) for row in rows if row.physics]
        found[name] = selections(own)
        everything += own
    if len(found) > 1:
        found["all"] = selections(everything)
    return found
