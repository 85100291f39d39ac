"""The way of one attribute from its nominal value to an end of its range."""

from collections.abc import Mapping
from dataclasses import dataclass

from rtphys.physics.distribution import By, Distribution, SameAs, extremes
from rtphys.physics.domain import Domain
from rtphys.physics.registry import attribute
from rtphys.physics.values import Value, Vector


@dataclass(frozen=True)
class Axis:
    """One side of one attribute's range. Share 0 is the nominal value, share 1 the end.

    A vector (`center_of_mass`) goes towards the seed's own draw from the whole range, which lies
    inside every body. Where the nominal value is the asset's own (`object_joint_damping`), the
    way begins at the lower end of the range.
    """

    key: str
    nominal: float
    end: float
    held: Mapping[str, Value]  # further values that the attribute needs, such as a camera's mode
    vector: bool = False

    def value(self, share: float) -> float:
        """The value at a share of the way; of a vector the share itself times the range's end."""
        return self.end if share == 1 else self.nominal + share * (self.end - self.nominal)

    def overrides(self, share: float, drawn: Vector) -> dict[str, Value]:
        """What to hold in an episode; `drawn` is its own draw of a vector."""
        if self.vector:
            return {self.key: tuple(share * x for x in drawn)}
        return {**self.held, self.key: self.value(share)}


def axes(domain: Domain, key: str) -> list[Axis]:
    """Both sides of an attribute's range in a domain, or the one that there is; empty if fixed."""
    known, rule, held = attribute(key), domain.rules[key], dict[str, Value]()
    if isinstance(rule, SameAs):
        rule = domain.rules[rule.source]
    if isinstance(rule, By):  # the branch that reaches farthest
        selector = rule.selector
        mode, rule = max(rule.branches.items(), key=_reach)
        held = {selector: mode}
    low, high = _ends(rule)
    if known.size > 1:
        return [Axis(key, 0.0, max(abs(low), abs(high)), held, vector=True)] if low < high else []
    nominal = float(known.nominal) if isinstance(known.nominal, int | float) else low
    return [Axis(key, nominal, end, held) for end in (low, high) if end != nominal]


def _ends(rule: Distribution) -> tuple[float, float]:
    numbers = [v for v in extremes(rule) if isinstance(v, float)]
    return (min(numbers), max(numbers)) if numbers else (0.0, 0.0)


def _reach(branch: tuple[str, Distribution]) -> float:
    low, high = _ends(branch[1])
    return max(abs(low), abs(high))
