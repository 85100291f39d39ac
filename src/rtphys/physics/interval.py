"""A closed interval of numbers: what most physical attributes may be."""

from dataclasses import dataclass
from math import isfinite

from rtphys.physics.values import components


@dataclass(frozen=True)
class Interval:
    """All numbers from `low` to `high`, both ends included.

    Raises:
        ValueError: ends that are not finite or in the wrong order.
    """

    low: float
    high: float

    def __post_init__(self) -> None:
        if not (isfinite(self.low) and isfinite(self.high) and self.low <= self.high):
            raise ValueError(f"[{self.low}, {self.high}] is not an interval")

    def __contains__(self, value: object) -> bool:
        """Whether a number, or every component of a vector, lies in the interval."""
        parts = components(value)
        if isinstance(value, tuple):
            return all(part in self for part in parts)
        if isinstance(value, bool) or not isinstance(value, int | float):
            return False
        return self.low <= value <= self.high

    def __str__(self) -> str:
        return f"[{self.low:g}, {self.high:g}]"
