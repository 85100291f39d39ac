"""Success rates with confidence intervals, and tests whether two rates differ."""

from dataclasses import dataclass

import numpy as np
from scipy import stats

Z_95 = 1.959963984540054  # 97.5 % quantile of the standard normal distribution


@dataclass(frozen=True)
class Rate:
    """A success rate with its Wilson 95 % interval (Wilson 1927)."""

    successes: int
    trials: int

    @property
    def value(self) -> float | None:
        """None without a trial."""
        return self.successes / self.trials if self.trials else None

    @property
    def interval(self) -> tuple[float, float]:
        """Lower and upper bound of the rate, at 95 % confidence."""
        return wilson(self.successes, self.trials)

    def to_json(self) -> dict[str, float | int | None]:
        low, high = self.interval
        return {
            "successes": self.successes,
            "trials": self.trials,
            "rate": self.value,
            "low": low,
            "high": high,
        }


def wilson(successes: int, trials: int, z: float = Z_95) -> tuple[float, float]:
    """Wilson score interval (low, high) of a success rate; [0, 1] without a trial.

    `scipy.stats.BinomTestResult.proportion_ci` orders the same formula otherwise: every second
    pair of counts differs in the last bit, and summaries on disk hold all bits.
    """
    if trials == 0:
        return 0.0, 1.0
    p, n = successes / trials, float(trials)
    middle = (p + z * z / (2 * n)) / (1 + z * z / n)
    half = z / (1 + z * z / n) * float(np.sqrt(p * (1 - p) / n + z * z / (4 * n * n)))
    # Rounding must neither leave [0, 1] nor exclude an observed rate of 0 or 1.
    low = 0.0 if successes == 0 else max(middle - half, 0.0)
    return low, 1.0 if successes == trials else min(middle + half, 1.0)


@dataclass(frozen=True)
class Paired:
    """Outcomes of two conditions on the same trials, with McNemar's exact test."""

    both: int
    only_first: int
    only_second: int
    neither: int

    @property
    def trials(self) -> int:
        return self.both + self.only_first + self.only_second + self.neither

    @property
    def difference(self) -> float | None:
        """Success rate of the second condition minus that of the first; None without a trial."""
        return (self.only_second - self.only_first) / self.trials if self.trials else None

    @property
    def p(self) -> float:
        """p-value of McNemar's exact test that both rates are equal."""
        return mcnemar(self.only_first, self.only_second)

    def to_json(self) -> dict[str, float | int | None]:
        return {
            "trials": self.trials,
            "both": self.both,
            "only_first": self.only_first,
            "only_second": self.only_second,
            "neither": self.neither,
            "difference": self.difference,
            "p": self.p,
        }


def paired(outcomes: list[tuple[bool, bool]]) -> Paired:
    """Count pairs of outcomes, each (first condition succeeds, second succeeds)."""
    return Paired(
        both=sum(a and b for a, b in outcomes),
        only_first=sum(a and not b for a, b in outcomes),
        only_second=sum(b and not a for a, b in outcomes),
        neither=sum(not a and not b for a, b in outcomes),
    )


def mcnemar(only_first: int, only_second: int) -> float:
    """Two-sided p-value of McNemar's exact test that two paired success rates are equal.

    If they are, each of the discordant pairs goes either way with probability 1/2.
    """
    discordant = only_first + only_second
    return float(stats.binomtest(only_first, discordant, 0.5).pvalue) if discordant else 1.0


def holm(p: list[float]) -> list[float]:
    """p-values adjusted for the number of tests (Holm 1979), in the order given; scipy has no Holm.

    Args:
        p: (n,) unadjusted p-values.
    """
    adjusted, largest = [1.0] * len(p), 0.0
    for rank, index in enumerate(np.argsort(p, kind="stable").tolist()):
        largest = max(largest, min(1.0, (len(p) - rank) * p[index]))
        adjusted[index] = largest
    return adjusted
