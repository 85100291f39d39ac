"""Which physics breaks a policy: logistic regression of success on every attribute that varied."""

from collections import defaultdict
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
import scipy
from numpy.typing import NDArray

from rtphys.core.untrusted import JSON
from rtphys.physics.attribute import attribute, is_attribute
from rtphys.results.evaluation import EpisodeRecord
from rtphys.results.statistics import Rate, holm

Floats = NDArray[np.float64]
MIN_EPISODES = 10  # below which no curve is fitted
BINS = 5
SAME = 1e-9  # share by which rounding moves equal values, such as lengths of unit vectors
SIGNIFICANT = 0.05  # adjusted p-value below which an effect counts as one
# Standard deviations of the normal priors; both are wide and only matter at perfect separation.
SLOPE_SPREAD = 5.0  # of the change in log-odds over the whole range of x
LEVEL_SPREAD = 10.0  # of a group's log-odds at the smallest x


TOGETHER = (
    "Each effect is seen while the protocol's other attributes vary too; `rtphys sensitivity` "
    "moves one attribute alone, so the two may disagree."
)
"""What has to be said beside the effects."""


@dataclass(frozen=True)
class Curve:
    """Fitted curve: log-odds of success = levels[group] + slope * (x - low) / (high - low)."""

    low: float  # smallest x
    high: float  # largest x
    slope: float  # log-odds at `high` minus log-odds at `low`
    error: float  # its standard error
    levels: tuple[float, ...]  # log-odds at `low`, by group
    p: float  # of the likelihood-ratio test that the slope is zero

    def at(self, x: Floats) -> Floats:
        """Success rate at x (n,), averaged over the groups with equal weights -> (n,)."""
        share = (np.asarray(x, float) - self.low) / (self.high - self.low)
        rates = [scipy.special.expit(level + self.slope * share) for level in self.levels]
        return np.mean(rates, axis=0)


@dataclass(frozen=True)
class Break:
    """Effect of one physical attribute on success under one protocol."""

    key: str
    unit: str
    curve: Curve
    p_holm: float  # p-value of `curve`, adjusted for the number of attributes
    bins: tuple[tuple[float, float, Rate], ...]  # from, to, success rate
    same: tuple[str, ...] = ()  # attributes that always had the same values (one shared draw)

    @property
    def names(self) -> str:
        """Its attributes, in one cell."""
        return ", ".join([self.key, *self.same])

    @property
    def span(self) -> str:
        """What values they had, in one cell."""
        unit = "" if self.unit == "1" else f" {self.unit}"
        return f"{self.curve.low:.3g} to {self.curve.high:.3g}{unit}"

    def to_json(self) -> dict[str, JSON]:
        curve = self.curve
        return {
            "attribute": self.key,
            "same": list(self.same),
            "unit": self.unit,
            "low": curve.low,
            "high": curve.high,
            "log_odds": curve.slope,
            "log_odds_error": curve.error,
            "p": curve.p,
            "p_holm": self.p_holm,
            "bins": [{"from": a, "to": b, **rate.to_json()} for a, b, rate in self.bins],
        }


def breaks(records: Sequence[EpisodeRecord]) -> list[Break]:
    """Effects of the attributes that varied, by increasing p-value; empty if none can be fitted.

    A vector attribute counts by its norm. Episodes in which an attribute does not act say
    nothing of it. Every task has its own level in the regression. Attributes that share a draw
    cannot be separated: they make one entry.
    """
    columns = dict[str, list[float | None]]()  # values (n,) of each distinct attribute
    same = defaultdict[str, list[str]](list)  # attributes that repeat its values
    for key in sorted({key for r in records for key in r.physics if is_attribute(key)}):
        x = [None if key in r.inert else _number(r.physics.get(key)) for r in records]
        first = next((other for other, values in columns.items() if values == x), None)
        if first is None:
            columns[key] = x
        elif any(value is not None for value in x):
            same[first].append(key)
    effects: list[Break] = []
    for key, column in columns.items():
        acting = [(x, r) for x, r in zip(column, records, strict=True) if x is not None]
        if len(acting) < MIN_EPISODES:
            continue
        x, success = [x for x, _ in acting], [r.success for _, r in acting]
        tasks = sorted({r.task for _, r in acting})  # a level without episodes would be 50 %
        curve = fit(x, success, [tasks.index(r.task) for _, r in acting])
        if curve is not None:
            unit, others = attribute(key).unit, tuple(same[key])
            effects.append(Break(key, unit, curve, curve.p, tuple(bins(x, success)), others))
    adjusted = holm([effect.curve.p for effect in effects])
    effects = [replace(effect, p_holm=p) for effect, p in zip(effects, adjusted, strict=True)]
    return sorted(effects, key=lambda effect: effect.curve.p)


def without_evidence(breaks: Mapping[str, Sequence[Break]]) -> list[str]:
    """A line for each protocol under which no attribute has a significant effect."""
    return [
        f"{protocol}: no attribute has a significant effect (p with Holm's correction below "
        f"{SIGNIFICANT}); the first is only the most suspect"
        for protocol, effects in breaks.items()
        if effects and all(effect.p_holm >= SIGNIFICANT for effect in effects)
    ]


def drawn_together(effects: Iterable[Break]) -> list[tuple[str, ...]]:
    """The attributes of each effect that has several, each group once."""
    return [*dict.fromkeys((effect.key, *effect.same) for effect in effects if effect.same)]


def _number(value: JSON) -> float | None:
    """A number as it is, a vector by its norm; None for anything else."""
    if isinstance(value, list | tuple):
        return float(np.linalg.norm(np.array(value, float)))
    if isinstance(value, bool) or not isinstance(value, int | float):
        return None
    return float(value)


def fit(
    x: Sequence[float], success: Sequence[bool], group: Sequence[int] | None = None
) -> Curve | None:
    """Fit a logistic curve; None where x or the outcome does not vary.

    Our own, because scipy has none, and the penalised ones of statsmodels give no standard error.
    Without the priors, a policy that fails exactly beyond some value would have an infinite slope.

    Args:
        x: (n,) any finite numbers.
        success: (n,).
        group: (n,) indices from 0 (the task). Each group has its own level, so that an easy task
            with larger values of x does not look like a slope.
    """
    values, y = np.asarray(x, float), np.asarray(success, float)
    if not len(values) or np.ptp(values) <= SAME * np.abs(values).max() or np.ptp(y) == 0:
        return None
    groups = np.zeros(len(values), int) if group is None else np.asarray(group, int)
    levels = np.eye(int(groups.max()) + 1)[groups]
    share = (values - values.min()) / np.ptp(values)
    # Inverse variances of the priors of the coefficients: the groups' levels, then the slope.
    weight = 1 / np.array([LEVEL_SPREAD] * levels.shape[1] + [SLOPE_SPREAD]) ** 2

    def minimum(X: Floats) -> "scipy.optimize.OptimizeResult":
        """The only minimum of the convex negative log-posterior of coefficients of X (n, k)."""
        w, sign = weight[: X.shape[1]], 2 * y - 1

        def hessian(b: Floats) -> Floats:
            rate = scipy.special.expit(X @ b)
            return (X * (rate * (1 - rate))[:, None]).T @ X + np.diag(w)

        return scipy.optimize.minimize(
            lambda b: float(-scipy.special.log_expit(sign * (X @ b)).sum() + 0.5 * w @ b**2),
            np.zeros(X.shape[1]),
            jac=lambda b: X.T @ (scipy.special.expit(X @ b) - y) + w * b,
            hess=hessian,
            method="trust-exact",
            options={"gtol": 1e-8},
        )

    full, flat = minimum(np.column_stack([levels, share])), minimum(levels)
    return Curve(
        low=float(values.min()),
        high=float(values.max()),
        slope=float(full.x[-1]),
        error=float(np.sqrt(np.linalg.inv(full.hess)[-1, -1])),
        levels=tuple(full.x[:-1].tolist()),
        p=float(scipy.stats.chi2.sf(max(2 * (flat.fun - full.fun), 0.0), 1)),
    )


def bins(x: Sequence[float], success: Sequence[bool]) -> list[tuple[float, float, Rate]]:
    """Success rates in bins of equal width: (from, to, rate); empty bins are omitted. n >= 1."""
    y = np.asarray(success, float)
    (sums, counts), edges, _ = scipy.stats.binned_statistic(x, [y, np.ones_like(y)], "sum", BINS)
    return [
        (float(edges[k]), float(edges[k + 1]), Rate(int(sums[k]), int(counts[k])))
        for k in range(BINS)
        if counts[k]
    ]
