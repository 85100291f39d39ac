"""Records what the fingers feel: forces at every step, poses more rarely, contacts at every frame.

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
from rtphys.sim.contacts import Contacts, presses
from rtphys.sim.engine import from_sapien
from rtphys.sim.world import World

HANDS = frozenset(("left_gripper", "right_gripper"))
POSE_STEPS = 5  # from one pose to the next, a third of a frame: at each step they double the cost


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
    packed: list[bytes]  # `scene.pack_poses()` before the first step, every POSE_STEPS, at the end
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
        self._contacts = contacts
        self._articulation = world.robot.articulation
        fingers = [link for arm in world.robot.arms for link in arm.finger_links]
        names = [link.name for link in self._articulation.links]
        rows = {entity.per_scene_id: row for row, entity in enumerate(world.scene.entities)}
        # Looked up by the body itself: asking a contact for entities and ids costs 2 us.
        self._rows = {body: rows.get(body.entity.per_scene_id, -1) for body in contacts.bodies}
        joints = [link.joint.pose_in_child for link in fingers]
        self.track = TouchTrack(
            tuple(link.name for link in fingers),
            tuple(names.index(link.name) for link in fingers),
            tuple(self._rows[link] for link in fingers),
            friction,
            np.array([quat_to_matrix(from_sapien(pose).q) for pose in joints]),
        )
        self._wrenches: list[NDArray[np.float32]] = []
        self._pack = world.scene.pack_poses
        self._packed = [self._pack()]

    def step(self) -> None:
        """After a physics step."""
        self._wrenches.append(self._articulation.link_incoming_joint_forces)
        if len(self._wrenches) % POSE_STEPS == 0:
            self._packed.append(self._pack())

    def frame(self) -> None:
        """Keeps the steps since the last frame, and what presses now. Begins the next frame."""
        self.track.rows.append(self.peek())
        self._wrenches, self._packed = [], self.track.rows[-1].packed[-1:]

    def peek(self) -> TouchRow:
        """The frame that has begun, as if it ended now."""
        since = len(self._wrenches) % POSE_STEPS
        packed = [*self._packed, self._pack()] if since else self._packed[:]
        return TouchRow(self._wrenches[:], packed, tuple(self._presses()))

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
                    (*point.impulse.tolist(), *point.position.tolist())
                    for point in contact.points
                    if presses(point)
                ]
                if found:
                    points.setdefault(self._bodies_of(contact, names), []).extend(found)
            yield from (_press(names, rows, found) for rows, found in points.items())

    def _bodies_of(self, contact: physx.PhysxContact, names: tuple[str, str]) -> tuple[int, int]:
        first, second = contact.bodies
        if self._contacts.owner(first) != names[0]:
            first, second = second, first
        return self._rows[first], self._rows[second]


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
