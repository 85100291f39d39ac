"""What a proof is: a law, the settings to try it at, and the numbers that come out."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field

import numpy as np

from rtphys.core.poses import Array
from rtphys.physics.values import Value
from rtphys.proofs.lab import Lab

Company = Mapping[str, Value]  # other attributes held at the same time


@dataclass(frozen=True, eq=False)
class Trace:
    """What one experiment recorded, beside what the law says, for the figure."""

    x: Array
    measured: Array
    law: Array
    x_label: str
    y_label: str


@dataclass(frozen=True, eq=False)
class Trial:
    """One number: what the textbook says and what the simulator did."""

    what: str  # "acceleration under 0.5 N"
    expected: float
    measured: float
    unit: str
    full: float = 0.0  # size to compare with where the expected value is zero or near it
    tolerance: float = 0.03
    setting: str = ""  # "object_mass = 4"; filled in by the runner
    trace: Trace | None = None

    @property
    def error(self) -> float:
        """|measured - expected| over the larger of |expected| and `full`."""
        if not np.isfinite(self.measured):
            return float("inf")
        size = max(abs(self.expected), self.full)
        return abs(self.measured - self.expected) / size if size else float("inf")

    @property
    def passed(self) -> bool:
        return self.error <= self.tolerance


@dataclass(frozen=True)
class Proof:
    """The law of one attribute.

    Args:
        key: the attribute.
        law: one line with the formula.
        settings: nominal and both ends of the global domain, perhaps more; at least one of them
            far enough from nominal that an attribute which does nothing must fail.
        run: the experiments at one setting.
        company: what else may be changed at the same time; the law must still hold.
    """

    key: str
    law: str
    settings: tuple[Value, ...]
    run: Callable[[Lab, Value, Company], list[Trial]]
    company: tuple[Company, ...] = field(default_factory=tuple)


def number(value: Value) -> float:
    """A setting that must be a number."""
    if not isinstance(value, int | float):
        raise TypeError(f"{value!r} is not a number")
    return float(value)
