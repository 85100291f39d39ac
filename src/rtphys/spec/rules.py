"""The rules by which a spec draws physics and looks, resolved: what a manifest stores."""

from collections.abc import Collection, Mapping
from dataclasses import dataclass, field
from typing import Literal

from rtphys.core.seeds import Chance
from rtphys.physics.domain import Domain
from rtphys.physics.reach import Inside
from rtphys.physics.values import Physics, Value
from rtphys.spec.protocol import VisualRandomization

Source = Literal["nominal", "domain", "set", "look"]
TABLE_HEIGHT = "table_height"  # the attribute that a look without physics moves


@dataclass(frozen=True)
class Rules:
    """By what the physics and the look of an episode are drawn from its seed.

    A protocol without physics may still lower the table, as RoboTwin does. The height is then
    drawn by the look, and put into the world, read back and labelled as any other attribute.
    """

    domain: Domain
    visual: VisualRandomization | None = None  # None: looks as in protocol clean
    only: Collection[str] | None = None
    overrides: Mapping[str, Value] = field(default_factory=dict[str, Value])
    task: str = ""  # whose streams; empty: those that all tasks share

    def chance(self, seed: int) -> Chance:
        """The streams of physics and look."""
        return Chance(seed, self.task)

    def draw(self, seed: int, inside: Inside | None = None) -> Physics:
        """The physics of one episode; arguments and errors are those of `Domain.sample`."""
        held = dict(self.overrides)
        if self.visual is not None and self._look_lowers:
            share = float(self.chance(seed).stream("visual", TABLE_HEIGHT).uniform())
            held[TABLE_HEIGHT] = 0.0 - self.visual.table_drop * share  # never -0.0
        return self.domain.sample(seed, self.only, held, inside, self.task)

    @property
    def held(self) -> frozenset[str]:
        """Keys whose value does not come from the domain."""
        look = (TABLE_HEIGHT,) if self._look_lowers else ()
        return frozenset((*self.overrides, *look))

    @property
    def _look_lowers(self) -> bool:
        drop = self.visual.table_drop if self.visual is not None else 0.0
        return drop > 0 and TABLE_HEIGHT not in self.overrides

    def source(self, key: str, physics: Physics) -> Source:
        """Where the value of an attribute comes from."""
        if key not in physics.varied:
            return "nominal"
        if key in self.overrides:
            return "set"
        return "look" if key in self.held else "domain"
