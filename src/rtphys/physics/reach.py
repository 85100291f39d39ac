"""Keys of physics such as `friction@left_block`: an attribute, and the one prop that has the value.

A key without a prop is for all props that have no value of their own. What a key is for is its
`Reach`; an attribute is applied to, and read from, that part of the world alone.
"""

from collections.abc import Callable, Collection, Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import TypeVar

from rtphys.physics.handles import Body, Joint, Surface, World
from rtphys.physics.values import Vector

MARK = "@"
Part = TypeVar("Part")


def split(key: str) -> tuple[str, str]:
    """Attribute and prop of a key; no prop: an empty text."""
    name, _, prop = key.partition(MARK)
    return name, prop


def keys_of(name: str, keys: Iterable[str]) -> list[str]:
    """Those of the keys that are of an attribute: the one for all first, then those of props."""
    return sorted(key for key in keys if split(key)[0] == name)


@dataclass(frozen=True)
class Reach:
    """The props that the value of a key is for: one, or all but those with a value of their own."""

    prop: str = ""
    others: frozenset[str] = frozenset()

    def has(self, name: str) -> bool:
        """Whether the value is for a prop, or for a body, surface or joint (`door/hinge`)."""
        owner = name.partition("/")[0]
        return owner == self.prop if self.prop else owner not in self.others

    def parts(self, of_props: Mapping[str, Collection[Part]]) -> frozenset[Part]:
        """What the props that it is for have together, from what each prop has."""
        return frozenset(part for prop, own in of_props.items() if self.has(prop) for part in own)


Inside = Callable[[Vector, Reach], bool]
"""Whether a centre of mass, offset by (3,) [m], lies inside every body that it is for."""


def reach(key: str, keys: Iterable[str] = ()) -> Reach:
    """What a key is for, beside others."""
    name, prop = split(key)
    own = frozenset(split(other)[1] for other in keys_of(name, keys)) - {""}
    return Reach(prop, frozenset() if prop else own)


@dataclass(frozen=True)
class Reached:
    """The part of a world that a reach has: all that an attribute of single props may look at."""

    world: World
    reach: Reach

    @property
    def bodies(self) -> Sequence[Body]:
        return [body for body in self.world.bodies if self.reach.has(body.name)]

    @property
    def surfaces(self) -> Sequence[Surface]:
        return [surface for surface in self.world.surfaces if self.reach.has(surface.name)]

    @property
    def joints(self) -> Sequence[Joint]:
        return [joint for joint in self.world.joints if self.reach.has(joint.name)]

    @property
    def table_and_pads(self) -> Sequence[Surface]:
        return self.world.table_and_pads
