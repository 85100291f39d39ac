"""How far along an axis at least half of the paired seeds still succeed."""

from collections.abc import Sequence
from dataclasses import dataclass, field

from rtphys.data.episode import JSON
from rtphys.results.statistics import wilson
from rtphys.studies.sensitivity.axis import Axis


@dataclass
class Level:
    """Results at one share of the way."""

    share: float
    successes: int = 0
    of: int = 0

    @property
    def held(self) -> bool:
        """Whether at least half of the seeds succeed."""
        return 2 * self.successes >= self.of


@dataclass
class Bisection:
    """Tests the end, then halves what is open, `steps` times. Assumes that success only falls."""

    axis: Axis
    steps: int
    levels: list[Level] = field(default_factory=list[Level])

    @property
    def bracket(self) -> tuple[float, float]:
        """Largest share that holds and smallest that does not; both 1 where the end holds."""
        low = max((level.share for level in self.levels if level.held), default=0.0)
        high = min((level.share for level in self.levels if not level.held), default=1.0)
        return min(low, high), high

    @property
    def next(self) -> float | None:
        """The share to test next; None when the answer stands."""
        if not self.levels:
            return 1.0
        if self.levels[0].held or len(self.levels) > self.steps:
            return None
        return sum(self.bracket) / 2

    @property
    def interval(self) -> tuple[float, float]:
        """Shares between which the answer lies with 95 % confidence, as far as they were tested.

        Up to the first, more than half of the seeds are sure to succeed; from the second on, fewer.
        """
        sure = [(level.share, wilson(level.successes, level.of)) for level in self.levels]
        above = [share for share, (low, _) in sure if low > 0.5]
        below = [share for share, (_, high) in sure if high < 0.5]
        return max(above, default=0.0), min(below, default=1.0)

    def to_json(self) -> dict[str, JSON]:
        """Values, not shares; levels in the order in which they were tested."""
        value = self.axis.value
        low, high = self.interval
        return {
            "end": self.axis.end,
            "tolerance": value(self.bracket[0]),
            "interval": [value(low), value(high)],
            "levels": [
                {"value": value(level.share), "successes": level.successes, "of": level.of}
                for level in self.levels
            ],
        }


def answer(sides: Sequence[Bisection]) -> dict[str, JSON]:
    """What is known of one attribute: its range, the tolerated part of it, and every level tested.

    `share` is the tolerated part of the range's width. `nominal` is what the search began at.
    """
    axes, (first, *_) = [side.axis for side in sides], sides
    reached = [axis.value(side.bracket[0]) for axis, side in zip(axes, sides, strict=True)]
    nominal, ends = first.axis.nominal, [axis.end for axis in axes]
    widths = [abs(end - nominal) for end in ends]
    tolerated = sum(abs(value - nominal) for value in reached)
    return {
        "nominal": nominal,
        "range": [min(nominal, *ends), max(nominal, *ends)],
        "tolerance": [min(nominal, *reached), max(nominal, *reached)],
        "share": tolerated / sum(widths),
        "sides": [side.to_json() for side in sides],
    }
