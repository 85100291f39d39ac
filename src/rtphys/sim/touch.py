"""Records what the fingers feel: forces and poses at every step, contacts at every frame.

PhysX tells the normal impulse of a contact, never its friction. So a finger's force is what its
joint transmits (force, then torque, in the joint's own frame), which is what a sensor in the
finger's root would feel: normal and tangential parts together. Contacts are read only where a hand
is one of the two, because a point costs 5 us and a scene has dozens.
"""

import math
from collections.abc import Iterator
from dataclasses import dataclass, field
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from sapien import physx

from rtphys.core.poses import Array, quat_to_matrix
from rtphys.sim.contacts import Contacts
from rtphys.sim.engine import from_sapien
from rtphys.sim.world import World

HANDS = frozenset(("left_gripper", "right_gripper"))


class Press(NamedTuple):
    """Two bodies that press on each other at one instant; sums over all their contact points."""

    names: tuple[str, str]  # of the objects or surfaces, as tasks call them, sorted
    bodies: tuple[int, int]  # rows of the packed poses, likewise; -1: one that is not packed
    impulse: tuple[float, float, float]  # [N s] of the normal forces, up to its sign
    strength: float  # [N s] sum of their magnitudes
    point: tuple[float, float, float]  # [m] mean of the points, weighted by impulse; world


@dataclass(frozen=True, eq=False)
class TouchRow:
    """One frame: the n steps that ended in it, as the simulator reports them."""

    wrenches: list[NDArray[np.float32]]  # n of (L, 6): force [N], torque [N m] on each link
    packed: list[bytes]  # n + 1 of `scene.pack_poses()`, from the frame before on
    presses: tuple[Press, ...]  # at the frame


@dataclass(frozen=True, eq=False)
class TouchTrack:
    """What was recorded of an episode."""

    fingers: tuple[str, ...]  # names of the F finger links, left hand first
    links: tuple[int, ...]  # their rows of the wrenches
    bodies: tuple[int, ...]  # their rows of the packed poses
    friction: float  # coefficient between a pad and an object
    joints: Array  # (F, 3, 3) rotation from a finger's joint frame to its link's
    rows: list[TouchRow] = field(default_factory=list)


class TouchRecorder:
    """Called after every step, and at every frame."""

    def __init__(self, world: World, contacts: Contacts, friction: float) -> None:
        self._world, self._contacts = world, contacts
        self._articulation = world.robot.articulation
        fingers = [link for arm in world.robot.arms for link in arm.finger_links]
        names = [link.name for link in self._articulation.links]
        ids = [entity.per_scene_id for entity in world.scene.entities]
        self._rows = {scene_id: row for row, scene_id in enumerate(ids)}
        joints = [link.joint.pose_in_child for link in fingers]
        self.track = TouchTrack(
            tuple(link.name for link in fingers),
            tuple(names.index(link.name) for link in fingers),
            tuple(self._rows[link.entity.per_scene_id] for link in fingers),
            friction,
            np.array([quat_to_matrix(from_sapien(pose).q) for pose in joints]),
        )
        self._wrenches: list[NDArray[np.float32]] = []
        self._packed = [world.scene.pack_poses()]

    def step(self) -> None:
        """After a physics step."""
        self._wrenches.append(self._articulation.link_incoming_joint_forces)
        self._packed.append(self._world.scene.pack_poses())

    def frame(self) -> None:
        """Keeps the steps since the last frame, and what presses now. Begins the next frame."""
        self.track.rows.append(self.peek())
        self._wrenches, self._packed = [], self._packed[-1:]

    def peek(self) -> TouchRow:
        """The frame that has begun, as if it ended now."""
        return TouchRow(self._wrenches[:], self._packed[:], tuple(self._presses()))

    def last(self) -> TouchRow:
        """The frame that has begun, or the one before if no step was made since."""
        return self.peek() if self._wrenches else self.track.rows[-1]

    def _presses(self) -> Iterator[Press]:
        for names, contacts in self._contacts.near().items():
            if HANDS.isdisjoint(names):
                continue
            points: dict[tuple[int, int], list[tuple[float, ...]]] = {}
            for contact in contacts:
                found = [
                    (*impulse, *point.position.tolist())
                    for point in contact.points
                    if any(impulse := point.impulse.tolist())
                ]
                if found:
                    points.setdefault(self._bodies_of(contact, names), []).extend(found)
            yield from (_press(names, rows, found) for rows, found in points.items())

    def _bodies_of(self, contact: physx.PhysxContact, names: tuple[str, str]) -> tuple[int, int]:
        first, second = contact.bodies
        if self._contacts.owner(first) != names[0]:
            first, second = second, first
        rows = self._rows
        return rows.get(first.entity.per_scene_id, -1), rows.get(second.entity.per_scene_id, -1)


def _press(
    names: tuple[str, str], bodies: tuple[int, int], points: list[tuple[float, ...]]
) -> Press:
    """Plain floats: numpy would take three times as long for a handful of points."""
    sums, strength = [0.0] * 6, 0.0
    for x, y, z, *position in points:
        size = math.sqrt(x * x + y * y + z * z)
        strength += size
        for i, value in enumerate((x, y, z, *(size * p for p in position))):
            sums[i] += value
    ix, iy, iz, px, py, pz = sums
    return Press(
        names, bodies, (ix, iy, iz), strength, (px / strength, py / strength, pz / strength)
    )
