"""From contact points to end-effector poses: how a gripper can take hold of an object.

Geometry of RoboTwin's fact sheet, section 1.5; all poses in one frame (the task frame).
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from rtphys.assets.embodiment import Hand
from rtphys.core.poses import Array, Pose, axis_angle, quat_multiply

TILTS = tuple(0.1 * i for i in range(10))  # [rad] towards the robot (RoboTwin: 0 .. 0.9)

# Preferred orientations (approach, camera-up): straight down with the wrist turned 30 deg
# inward, and the level approach from the arm's own side.
_S30, _C30, _H = 0.5, np.sqrt(3) / 2, np.sqrt(0.5)


def orientation(approach: Sequence[float] | Array, camera_up: Sequence[float] | Array) -> Array:
    """ee quaternion wxyz from its x (approach) and z (camera-up) directions."""
    x = np.asarray(approach, float) / np.linalg.norm(approach)
    z = np.asarray(camera_up, float)
    z = z - (z @ x) * x
    z = z / np.linalg.norm(z)
    return Pose.from_matrix(np.column_stack([x, np.cross(z, x), z])).q


TOP_DOWN = {
    "left": orientation((0, 0, -1), (_S30, _C30, 0)),
    "right": orientation((0, 0, -1), (-_S30, _C30, 0)),
}
SIDEWAYS = {
    "left": orientation((_H, _H, 0), (0, 0, 1)),
    "right": orientation((-_H, _H, 0), (0, 0, 1)),
}
STRAIGHT_DOWN = orientation((0, 0, -1), (0, 1, 0))


@dataclass(frozen=True, eq=False)
class Grasp:
    """A candidate: the ee pose at a contact point, and its cost; the lowest is tried first."""

    contact: int
    ee: Pose  # fingers around the contact point, at depth 0
    cost: float

    def backed_off(self, distance: float) -> Pose:
        """The same pose `distance` [m] back along the approach."""
        return self.ee.moved(-distance * self.ee.R[:, 0])


def ee_of_contact(contact: Pose, hand: Hand) -> Pose:
    """ee pose whose TCP is at a contact frame: approach = -y, closing = -z, camera-up = x."""
    C = contact.R
    R = np.column_stack([-C[:, 1], -C[:, 2], C[:, 0]])
    return Pose(contact.p + hand.tcp * C[:, 1], Pose.from_matrix(R).q)


def tilted(ee: Pose, pivot: Array, angle: float) -> list[Pose]:
    """The pose turned by +-angle [rad] about the gripper's y axis through a pivot.

    The one whose wrist is nearer to the robot comes first.
    """
    poses = []
    for signed in (-angle, angle):
        q = quat_multiply(ee.q, axis_angle((0, 1, 0), signed))
        turned = Pose((0, 0, 0), q)
        poses.append(Pose(pivot - np.linalg.norm(pivot - ee.p) * turned.R[:, 0], q))
    return sorted(poses, key=lambda pose: float(pose.p[1]))


def raised_clear(ee: Pose, table_top: float, hand: Hand, clearance: float = 0.003) -> Pose:
    """Shift back along the approach until the fingertips clear the table.

    Official contact points on thin objects lie deeper than the fingertips may go.
    """
    R = ee.R
    tip = ee.p + hand.tip * R[:, 0]
    spread = hand.pad_half_width * abs(R[2, 2]) + hand.pad_half_thickness * abs(R[2, 1])
    missing = table_top + clearance - (tip[2] - spread)
    descent = -R[2, 0]
    if missing <= 0 or descent < 0.2:  # a level hand cannot help itself by backing off
        return ee
    return ee.moved(-missing / descent * R[:, 0])


def angle_share(a: Array, b: Array) -> float:
    """Angle between two orientations as a share of half a turn."""
    return float(2 * np.arccos(np.clip(abs(a @ b), 0, 1)) / np.pi)


def preference(ee: Pose, side: str) -> float:
    """Cost of an ee orientation for an arm; 0 is best: downward, then from its own side."""
    down, sideways = angle_share(ee.q, TOP_DOWN[side]), angle_share(ee.q, SIDEWAYS[side])
    if down < 0.15:
        return down
    if sideways < 0.15:
        return 0.15 + sideways
    return 0.3 + 0.7 * down + 0.3 * sideways


def candidates(
    contacts: Sequence[tuple[int, Pose]], side: str, table_top: float, hand: Hand
) -> Iterator[Grasp]:
    """Grasps, best first: every contact point, both flips of the hand, ten tilts.

    Args:
        contacts: number and frame of each contact point.
        table_top: height that the fingertips must clear [m]; -inf where none is wanted.
    """
    options: list[tuple[float, int, Pose, Array, float, int]] = []
    for number, contact in contacts:
        straight = ee_of_contact(contact, hand)
        flip = Pose(straight.p, quat_multiply(straight.q, axis_angle((1, 0, 0), np.pi)))
        for ee, extra in ((straight, 0.0), (flip, 0.05)):
            base = preference(ee, side) + extra
            options.append((base, number, ee, contact.p, 0.0, 0))
            for tilt in TILTS[1:]:
                cost = base + 0.35 * tilt
                options.append((cost, number, ee, contact.p, tilt, 0))
                options.append((cost + 0.15, number, ee, contact.p, tilt, 1))
    seen: set[tuple[float, ...]] = set()
    for cost, number, ee, pivot, tilt, farther in sorted(options, key=lambda option: option[0]):
        # Poses are made when asked for: one of the first few is usually taken.
        turned = tilted(ee, pivot, tilt)[farther] if tilt else ee
        grasp = Grasp(number, raised_clear(turned, table_top, hand), cost)
        if _is_new(grasp, seen):
            yield grasp


def _is_new(grasp: Grasp, seen: set[tuple[float, ...]]) -> bool:
    """Opposite contact points and both flips of the hand describe most poses twice."""
    key = tuple(np.round(np.concatenate([grasp.ee.p, grasp.ee.R[:, :2].ravel()]), 4) + 0.0)
    if key in seen:
        return False
    seen.add(key)
    return True
