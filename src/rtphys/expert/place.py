"""Where the hand must go so that what it holds arrives where it should (fact sheet, 1.6)."""

from dataclasses import dataclass

import numpy as np

from rtphys.core.poses import Array, Pose, axis_angle, quat_multiply, rotation_between
from rtphys.task.arm import Placing


@dataclass(frozen=True, eq=False)
class Held:
    """What the hand holds, in one frame: the hand, the thing, and the point that must arrive."""

    side: str
    ee: Pose
    thing: Pose
    point: Pose | None  # functional point, or None for the thing's origin


def _aligning(held: Held, up: Array) -> Array:
    """Smallest turn that brings the point's z (or the thing's own +y) along +-`up`."""
    axis = held.point.R[:, 2] if held.point is not None else held.thing.R[:, 1]
    if abs(float(axis @ up)) > 1 - 1e-9:  # parallel or antiparallel: leave it
        return np.array([1.0, 0, 0, 0])
    return rotation_between(axis, up if held.point is not None or axis @ up >= 0 else -up)


def _turn_about(up: Array, from_: Array, to: Array) -> Array:
    """Turn about `up` that brings one direction's horizontal part onto another's."""
    a, b = from_ - (from_ @ up) * up, to - (to @ up) * up
    if np.linalg.norm(a) < 1e-6 or np.linalg.norm(b) < 1e-6:
        return np.array([1.0, 0, 0, 0])
    return axis_angle(up, float(np.arctan2(np.cross(a, b) @ up, a @ b)))


def turn_of(held: Held, target: Pose, how: Placing) -> Array:
    """Rotation of hand and thing together, world axes, wxyz."""
    up = target.R[:, 2]
    turn = _aligning(held, up)
    R_turn = Pose((0, 0, 0), turn).R
    if how.mode == "align":
        axis = held.point.R[:, 0] if held.point is not None else held.thing.R[:, 0]
        spin = _turn_about(up, R_turn @ axis, target.R[:, 0])
    elif how.mode == "auto":
        reach = (held.point or held.thing).p - held.ee.p
        if abs(reach[2]) <= 0.1:  # held from the side: fingers forward and inward
            inward = np.array([1.0 if held.side == "left" else -1.0, 1.0, 0.0])
            spin = _turn_about(up, R_turn @ reach, inward)
        else:  # held from above: camera-up away from the robot
            spin = _turn_about(up, R_turn @ held.ee.R[:, 2], np.array([0.0, 1.0, 0.0]))
    else:
        spin = np.array([1.0, 0, 0, 0])
    return quat_multiply(spin, turn)


def goals(held: Held, target: Pose, how: Placing, yaw: float = 0.0) -> tuple[Pose, Pose]:
    """ee poses before and at the placement.

    Args:
        yaw: extra turn about the target's z [rad].
    """
    up = target.R[:, 2]
    turn = quat_multiply(axis_angle(up, yaw), turn_of(held, target, how))
    R = Pose((0, 0, 0), turn).R
    point = held.point or held.thing
    away = R @ (held.thing.p - held.ee.p)
    ee_p = target.p + R @ (held.ee.p - point.p)
    along = up if how.along == "point" else away / max(float(np.linalg.norm(away)), 1e-9)
    q = quat_multiply(turn, held.ee.q)
    return Pose(ee_p - how.pre * along, q), Pose(ee_p - how.gap * along, q)
