"""Records what the fingers feel: forces at every step, poses more rarely, contacts at every frame.

PhysX tells the normal impulse of a contact, never its friction. So a finger's force is what its
joint transmits (force, then torque, in the joint's own frame), which is what a sensor in the
finger's root would feel: normal and tangential parts together. Contacts are read only where a hand
is one of the two, because a point costs 2 us and a scene has dozens. All that can wait is left to
`rtphys.episode.touch`, which computes it for all frames at once.
"""

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from rtphys.core.poses import Array, quat_to_matrix
from rtphys.physics.reach import keys_of, split
from rtphys.physics.values import Physics
from rtphys.sim.contacts import Body, Contacts, impulses
from rtphys.sim.engine import from_sapien
from rtphys.sim.world import World

HANDS = frozenset(("left_gripper", "right_gripper"))
POSE_STEPS = 5  # from one pose to the next, a third of a frame: at each step they double the cost


class Pair(NamedTuple):
    """Two bodies, one of them of a hand, that pressed on each other at some frame."""

    names: tuple[str, str]  # of the objects or surfaces, as tasks call them, sorted
    bodies: tuple[int, int]  # rows of the packed poses, likewise; -1: one that is not packed


class TouchRow(NamedTuple):
    """One frame: the n steps that ended in it, as the simulator reports them."""

    wrenches: list[NDArray[np.float32]]  # n of (L, 6): force [N], torque [N m] on each link
    packed: list[bytes]  # `scene.pack_poses()` before the first step, every POSE_STEPS, at the end
    pairs: list[int]  # of each point that presses at the frame: its row of `TouchTrack.pairs`
    points: list[float]  # six numbers of each: impulse [N s] up to its sign, place [m] in the world


@dataclass(frozen=True, eq=False)
class TouchTrack:
    """What was recorded of an episode."""

    fingers: tuple[str, ...]  # names of the F finger links, left hand first
    links: tuple[int, ...]  # their rows of the wrenches
    bodies: tuple[int, ...]  # their rows of the packed poses
    friction: Mapping[str, float]  # object -> coefficient between a pad and it; "": of the others
    joints: Array  # (F, 3, 3) rotation from a finger's joint frame to its link's
    pairs: list[Pair] = field(default_factory=list)  # all that pressed so far
    rows: list[TouchRow] = field(default_factory=list)


def in_hand(physics: Physics) -> dict[str, float]:
    """Coefficient between a pad and each object: `TouchTrack.friction`."""
    labels = {split(key)[1]: physics.scalar(key) for key in keys_of("friction", physics)}
    return {"table": min(labels.values()), **labels}


class TouchRecorder:
    """Called after every step, and at every frame."""

    def __init__(self, world: World, contacts: Contacts, friction: Mapping[str, float]) -> None:
        self._contacts = contacts
        articulation = world.robot.articulation
        fingers = [link for arm in world.robot.arms for link in arm.finger_links]
        names = [link.name for link in articulation.links]
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
        self._pairs: dict[tuple[Body, Body], int] = {}
        self._forces = articulation.get_link_incoming_joint_forces  # looked up once
        self._names: set[tuple[str, str]] = set()  # of the pairs that press at the last frame
        self._wrenches: list[NDArray[np.float32]] = []
        self._pack = world.scene.pack_poses
        self._packed = [self._pack()]

    def step(self) -> None:
        """After a physics step."""
        self._wrenches.append(self._forces())
        if len(self._wrenches) % POSE_STEPS == 0:
            self._packed.append(self._pack())

    def frame(self) -> None:
        """Keeps the steps since the last frame, and what presses now. Begins the next frame."""
        row, track = self.peek(), self.track
        track.rows.append(row)
        self._wrenches, self._packed = [], row.packed[-1:]
        self._names = {track.pairs[pair].names for pair in row.pairs}

    def peek(self) -> TouchRow:
        """The frame that has begun, as if it ended now."""
        since = len(self._wrenches) % POSE_STEPS
        packed = [*self._packed, self._pack()] if since else self._packed[:]
        pairs: list[int] = []
        points: list[float] = []
        for names, near in self._contacts.near().items():
            if HANDS.isdisjoint(names):
                continue
            for contact, first, second in near:
                if found := impulses(contact):
                    points += found
                    pairs += [self._pair((first, second), names)] * (len(found) // 6)
        return TouchRow(self._wrenches[:], packed, pairs, points)

    def last(self) -> TouchRow:
        """The frame that has begun, or the one before if no step was made since."""
        return self.peek() if self._wrenches else self.track.rows[-1]

    def pressing(self, hand: str, name: str) -> bool:
        """`Contacts.pressing` at the last frame, whose points are not read once more."""
        return ((hand, name) if hand < name else (name, hand)) in self._names

    def _pair(self, bodies: tuple[Body, Body], names: tuple[str, str]) -> int:
        """Row of two bodies, which is appended when they press for the first time."""
        known = self._pairs.get(bodies)
        if known is not None:
            return known
        first, second = bodies if self._contacts.owner(bodies[0]) == names[0] else bodies[::-1]
        pair = Pair(names, (self._rows[first], self._rows[second]))
        if pair not in self.track.pairs:  # a contact may name the two in either order
            self.track.pairs.append(pair)
        return self._pairs.setdefault(bodies, self.track.pairs.index(pair))
