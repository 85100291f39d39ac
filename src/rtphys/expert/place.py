"""Where the hand must go so that what it holds arrives where it should (fact sheet, 1.6)."""

from dataclasses import dataclass

import numpy as np

from rtphys.core.poses import Array, Pose, axis_angle, quat_multiply, rotation_between
from rtphys.task.arm import Placing


@dataclass(frozen=True, eq=False)
class HeldLoad:
    """An object in a hand; all poses are in one frame."""

    side: str
    ee: Pose
    pose: Pose  # of the object
    point: Pose | None  # functional point that must meet the target; None: the object's origin


def _aligning(load: HeldLoad, up: Array) -> Array:
    """Smallest rotation that brings the point's z (or the object's own +y) along +-`up`."""
    axis = load.point.R[:, 2] if load.point is not None else load.pose.R[:, 1]
    if abs(float(axis @ up)) > 1 - 1e-9:  # parallel or antiparallel: leave it
        return np.array([1.0, 0, 0, 0])
    return rotation_between(axis, up if load.point is not None or axis @ up >= 0 else -up)


def _turn_about(up: Array, from_: Array, to: Array) -> Array:
    """Rotation about `up` that brings the horizontal part of `from_` onto that of `to`."""
    a, b = from_ - (from_ @ up) * up, to - (to @ up) * up
    if np.linalg.norm(a) < 1e-6 or np.linalg.norm(b) < 1e-6:
        return np.array([1.0, 0, 0, 0])
    return axis_angle(up, float(np.arctan2(np.cross(a, b) @ up, a @ b)))


def turn_of(load: HeldLoad, target: Pose, how: Placing) -> Array:
    """Rotation of hand and object together that meets the target, wxyz, in the poses' frame."""
    up = target.R[:, 2]
    turn = _aligning(load, up)
    R_turn = Pose((0, 0, 0), turn).R
    if how.mode == "align":
        axis = load.point.R[:, 0] if load.point is not None else load.pose.R[:, 0]
        spin = _turn_about(up, R_turn @ axis, target.R[:, 0])
    elif how.mode == "auto":
        reach = (load.point or load.pose).p - load.ee.p
        if abs(reach[2]) <= 0.1:  # held from the side: fingers forward and inward
            inward = np.array([1.0 if load.side == "left" else -1.0, 1.0, 0.0])
            spin = _turn_about(up, R_turn @ reach, inward)
        else:  # held from above: camera-up away from the robot
            spin = _turn_about(up, R_turn @ load.ee.R[:, 2], np.array([0.0, 1.0, 0.0]))
    else:
        spin = np.array([1.0, 0, 0, 0])
    return quat_multiply(spin, turn)


def goals(load: HeldLoad, target: Pose, how: Placing, yaw: float = 0.0) -> tuple[Pose, Pose]:
    """The ee poses before and at the placement.

    Args:
        yaw: extra turn about the target's z [rad].
    """
    up = target.R[:, 2]
    turn = quat_multiply(axis_angle(up, yaw), turn_of(load, target, how))
    R = Pose((0, 0, 0), turn).R
    point = load.point or load.pose
    away = R @ (load.pose.p - load.ee.p)
    ee_p = target.p + R @ (load.ee.p - point.p)
    along = up if how.along == "point" else away / max(float(np.linalg.norm(away)), 1e-9)
    q = quat_multiply(turn, load.ee.q)
    return Pose(ee_p - how.pre * along, q), Pose(ee_p - how.gap * along, q)
