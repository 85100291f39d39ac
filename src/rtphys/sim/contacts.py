"""Which objects and surfaces press on each other, by the names that tasks use."""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import TypeAlias

import numpy as np
from sapien import physx

from rtphys.core.arithmetic import total
from rtphys.core.errors import UnknownName
from rtphys.core.poses import Array
from rtphys.sim.world import World

# [m] A step stops a body before it closes a gap: 4 mm are 1 m/s. The most seen is 0.2 mm.
REACH = 0.004
Body: TypeAlias = physx.PhysxRigidBaseComponent
# A contact and its two bodies: to ask it for them costs as much as to ask it for its points.
Near: TypeAlias = tuple[physx.PhysxContact, Body, Body]


@dataclass(frozen=True, eq=False)
class Touch:
    """All contact between two named objects or surfaces at one instant."""

    points: Array  # (n, 3) [m] world frame
    impulse: float  # [N s] sum of magnitudes over one step


class Contacts:
    """Contacts of the current step, read from the solver at most once a step."""

    def __init__(self, world: World) -> None:
        self._world, self._step = world, -1
        self._near: dict[tuple[str, str], list[Near]] = {}
        self._touches: dict[tuple[str, str], Touch | None] = {}
        # Keyed by the component itself: held here, it is the same object in every contact.
        table = world.room.table.find_component_by_type(physx.PhysxRigidStaticComponent)
        assert isinstance(table, physx.PhysxRigidStaticComponent)
        self._owner: dict[Body, str] = {table: "table"}
        owners = world.robot.link_owner()
        for link in world.robot.articulation.links:
            self._owner[link] = owners[link.name]
        for scene_object in world.scene_objects.values():
            for component in scene_object.links.values():
                self._owner[component] = scene_object.name
        self._pairs: dict[tuple[str, str], tuple[str, str]] = {}  # any two names -> sorted

    def between(self, a: str, b: str) -> Touch | None:
        """Contact with a positive impulse between the two now, or None. Raises `UnknownName`."""
        pair = self._pair(a, b)
        near = self.near().get(pair)
        if near is None:
            return None
        if pair not in self._touches:
            points = [p for contact, _, _ in near for p in contact.points if presses(p)]
            strength = total(float(np.linalg.norm(p.impulse)) for p in points)
            touch = Touch(np.array([p.position for p in points], float), strength)
            self._touches[pair] = touch if points else None
        return self._touches[pair]

    def pressing(self, a: str, b: str) -> bool:
        """Whether `between` has anything to tell; cheaper, for it stops at the first point."""
        near = self.near().get(self._pair(a, b), [])
        return any(presses(point) for contact, _, _ in near for point in contact.points)

    def _pair(self, a: str, b: str) -> tuple[str, str]:
        """Sorted. Raises `UnknownName`: a misspelt name would touch nothing, ever."""
        if (a, b) not in self._pairs:
            known = {*self._owner.values(), *self._world.objects}
            for name in (a, b):
                if name not in known:
                    raise UnknownName("object, hand or surface", name, known)
            self._pairs[a, b] = (a, b) if a < b else (b, a)
        return self._pairs[a, b]

    def near(self) -> Mapping[tuple[str, str], Sequence[Near]]:
        """All contacts of the step by the sorted names of the two, also those without impulse."""
        if self._step != self._world.steps:
            self._step, self._near, self._touches = self._world.steps, {}, {}
            owner = self._owner.get
            for contact in self._world.solver.get_contacts():
                first, second = contact.bodies
                a, b = owner(first), owner(second)
                if a is not None and b is not None and a != b:
                    pair = (a, b) if a < b else (b, a)
                    self._near.setdefault(pair, []).append((contact, first, second))
        return self._near

    @property
    def bodies(self) -> Iterable[Body]:
        """All bodies of objects, hands and surfaces; each is the same object in every contact."""
        return self._owner.keys()

    def owner(self, body: Body) -> str | None:
        """What tasks call the object or surface that a body belongs to; None: nothing of theirs."""
        return self._owner.get(body)


def presses(point: physx.PhysxContactPoint) -> bool:
    """Whether an impulse acts at the point: a pair is listed as soon as it is within the offset."""
    # The gap is a plain number, the impulse a new array: two of three points end at the first.
    return point.separation < REACH and any(point.impulse.tolist())


def impulses(contact: physx.PhysxContact) -> list[float]:
    """Six numbers for each point that `presses`, one after the other: impulse [N s], place [m]."""
    found: list[float] = []
    for point in contact.points:
        if point.separation < REACH and any(impulse := point.impulse.tolist()):
            found += impulse
            found += point.position.tolist()
    return found
