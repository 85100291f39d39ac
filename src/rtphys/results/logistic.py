"""Logistic regression of success on one number, and success rates in bins of that number.

Ours because neither numpy nor scipy has a logistic regression with a prior and standard errors.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy import optimize, stats
from scipy.special import expit, log_expit

from rtphys.results.statistics import Rate

Floats = NDArray[np.float64]
BINS = 5
# Standard deviations of the normal priors; both are wide and only matter at perfect separation.
SLOPE_SPREAD = 5.0  # of the change in log-odds over the whole range of x
LEVEL_SPREAD = 10.0  # of a group's log-odds at the smallest x


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
        return np.mean([expit(level + self.slope * share) for level in self.levels], axis=0)


def fit(
    x: Sequence[float],
    success: Sequence[bool],
    group: Sequence[int] | None = None,
    prior: bool = True,
) -> Curve | None:
    """Fit a logistic curve; None where x or the outcome does not vary.

    Args:
        x: (n,) any finite numbers.
        success: (n,).
        group: (n,) indices from 0 (the task). Each group has its own level, so that an easy task
            with larger values of x does not look like a slope.
        prior: use the normal priors above; False: plain maximum likelihood.
    """
    values, y = np.asarray(x, float), np.asarray(success, float)
    if not len(values) or np.ptp(values) == 0 or np.ptp(y) == 0:
        return None
    groups = np.zeros(len(values), int) if group is None else np.asarray(group, int)
    levels = np.eye(int(groups.max()) + 1)[groups]
    share = (values - values.min()) / np.ptp(values)
    spread = np.array([LEVEL_SPREAD] * levels.shape[1] + [SLOPE_SPREAD])
    weight = 1 / spread**2 if prior else np.zeros(len(spread))
    full, cost = _minimum(np.column_stack([levels, share]), y, weight)
    _, flat = _minimum(levels, y, weight[:-1])
    hessian = _hessian(np.column_stack([levels, share]), full, weight)
    return Curve(
        low=float(values.min()),
        high=float(values.max()),
        slope=float(full[-1]),
        error=float(np.sqrt(np.linalg.inv(hessian)[-1, -1])),
        levels=tuple(full[:-1].tolist()),
        p=float(stats.chi2.sf(max(2 * (flat - cost), 0.0), 1)),
    )


def _minimum(design: Floats, y: Floats, weight: Floats) -> tuple[Floats, float]:
    """Coefficients (k,) of the only minimum of the convex negative log-posterior, and its value.

    Args:
        design: (n, k).
        y: (n,) 0 or 1.
        weight: (k,) inverse variances of the prior.
    """
    sign = 2 * y - 1

    def cost(b: Floats) -> float:
        return float(-log_expit(sign * (design @ b)).sum() + 0.5 * weight @ b**2)

    def gradient(b: Floats) -> Floats:
        return design.T @ (expit(design @ b) - y) + weight * b

    minimum = optimize.minimize(
        cost,
        np.zeros(design.shape[1]),
        jac=gradient,
        hess=lambda b: _hessian(design, b, weight),
        method="trust-exact",
        options={"gtol": 1e-8},
    )
    return minimum.x, float(minimum.fun)


def _hessian(design: Floats, b: Floats, weight: Floats) -> Floats:
    """Second derivatives (k, k) of the negative log-posterior at the coefficients b (k,)."""
    rate = expit(design @ b)
    return (design * (rate * (1 - rate))[:, None]).T @ design + np.diag(weight)


def bins(x: Sequence[float], success: Sequence[bool]) -> list[tuple[float, float, Rate]]:
    """Success rates in bins of equal width: (from, to, rate); empty bins are omitted.

    Args:
        x, success: (n,), n >= 1.
    """
    values, y = np.asarray(x, float), np.asarray(success, bool)
    edges = np.linspace(values.min(), values.max(), BINS + 1)
    bin_of = np.clip(np.searchsorted(edges, values, side="right") - 1, 0, BINS - 1)
    return [
        (float(edges[k]), float(edges[k + 1]), Rate(int(y[bin_of == k].sum()), int(n)))
        for k in range(BINS)
        if (n := (bin_of == k).sum())
    ]
