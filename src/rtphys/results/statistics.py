"""Success rates with confidence intervals, and tests whether two rates differ."""

from collections import Counter
from collections.abc import Iterable, Sequence
from dataclasses import asdict, dataclass

import numpy as np
import scipy


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
        return {**asdict(self), "rate": self.value, "low": low, "high": high}


def rate_text(rate: Rate | None, bounds: bool = False) -> str:
    """Such as `98.1 % [90.2-99.7] 53/54`, the interval only with `bounds`; `-` without a trial."""
    if rate is None or rate.value is None:
        return "-"
    low, high = map(percent, rate.interval)
    between = f" [{low}-{high}]" if bounds else ""  # without a space a table does not break it
    return f"{percent(rate.value)} %{between} {rate.successes}/{rate.trials}"


def percent(share: float) -> str:
    """Such as `98.1` or `100`."""
    return f"{100 * share:.1f}".removesuffix(".0")


def wilson(successes: int, trials: int) -> tuple[float, float]:
    """Wilson score interval (low, high) of a success rate at 95 %; [0, 1] without a trial."""
    if trials == 0:
        return 0.0, 1.0
    interval = scipy.stats.binomtest(successes, trials).proportion_ci(method="wilson")
    return float(interval.low), float(interval.high)


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
    def p(self) -> float | None:
        """p-value of McNemar's exact test that both rates are equal; None without a trial."""
        return mcnemar(self.only_first, self.only_second) if self.trials else None

    def to_json(self) -> dict[str, float | int | None]:
        known = asdict(self)
        return {"trials": self.trials, **known, "difference": self.difference, "p": self.p}


def paired(outcomes: Iterable[tuple[bool, bool]]) -> Paired:
    """Counts pairs of outcomes, each (first condition succeeds, second succeeds)."""
    found = Counter(outcomes)
    kinds = [(True, True), (True, False), (False, True), (False, False)]
    return Paired(*(found[kind] for kind in kinds))


def mcnemar(only_first: int, only_second: int) -> float:
    """Two-sided p-value of McNemar's exact test that two paired success rates are equal.

    If they are, each of the discordant pairs goes either way with probability 1/2.
    """
    discordant = only_first + only_second
    return float(scipy.stats.binomtest(only_first, discordant, 0.5).pvalue) if discordant else 1.0


def holm(p: Sequence[float]) -> list[float]:
    """p-values (n,) adjusted for the number of tests, in their order (Holm 1979); not in scipy."""
    order = np.argsort(p, kind="stable")
    steps = np.arange(len(p), 0, -1) * np.asarray(p, float)[order]
    adjusted = np.minimum(np.maximum.accumulate(steps), 1.0)
    return adjusted[np.argsort(order)].tolist()
