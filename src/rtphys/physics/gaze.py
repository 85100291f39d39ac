"""How the head camera moves: along a sphere about its gaze point, straight, or turning."""

from typing import Literal

import numpy as np

from rtphys.core.poses import Array, Pose, axis_angle, quat_multiply, rotation_between
from rtphys.physics.handles import Camera
from rtphys.physics.values import Vector

Mode = Literal["orbit", "shift", "rotate"]
MODES: tuple[Mode, ...] = ("orbit", "shift", "rotate")


def gaze_point(camera: Camera) -> Array:
    """(3,) where the nominal optical axis meets the nominal table top, world frame [m]."""
    nominal = camera.nominal_pose
    return nominal.p + nominal.R @ np.array([camera.range_to_table, 0.0, 0.0])


def unturned(camera: Camera, p: Array, mode: str) -> Array:
    """Quaternion of a camera that moved to `p` and was not turned by `camera_angle`.

    In mode orbit that is the smallest turn that keeps the gaze point in the middle of the picture;
    in the others the nominal orientation.
    """
    nominal = camera.nominal_pose
    if mode != "orbit":
        return nominal.q
    gaze = gaze_point(camera)
    return quat_multiply(rotation_between(gaze - nominal.p, gaze - p), nominal.q)


def displaced(camera: Camera, mode: str, direction: Vector, distance: float) -> Array:
    """Position (3,) at `distance` [m] from the nominal one, world frame.

    `direction` is a unit vector in the camera frame. A shift goes along it; an orbit goes along
    its part across the optical axis, on the sphere about the gaze point, so that the straight
    line between old and new position (the chord) is `distance` and the range does not change.
    """
    nominal = camera.nominal_pose
    if mode != "orbit":
        return nominal.p + distance * (nominal.R @ np.asarray(direction))
    across = np.array([0.0, direction[1], direction[2]])
    if np.linalg.norm(across) < 1e-9:  # straight at the gaze point: any way across will do
        across = np.array([0.0, 1.0, 0.0])
    across /= np.linalg.norm(across)
    r = camera.range_to_table
    angle = 2 * np.arcsin(distance / (2 * r))
    return nominal.p + nominal.R @ (r * (np.sin(angle) * across + [1 - np.cos(angle), 0, 0]))


def turn(camera: Camera, mode: str) -> Array:
    """Rotation (4,) wxyz, in the unturned camera's frame, that the camera now has on top."""
    w, x, y, z = unturned(camera, camera.pose.p, mode)
    return quat_multiply((w, -x, -y, -z), camera.pose.q)


def angle_of(q: Array) -> float:
    """Rotation angle of a quaternion [rad]; by atan2, since arccos loses single precision."""
    return float(2 * np.arctan2(np.linalg.norm(q[1:]), abs(q[0])))


def move(camera: Camera, mode: str, direction: Vector, distance: float) -> None:
    """Put the camera at `distance` [m] from nominal; its turn stays."""
    kept = turn(camera, mode)
    p = displaced(camera, mode, direction, distance)
    camera.set_pose(Pose(p, quat_multiply(unturned(camera, p, mode), kept)))


def turn_by(camera: Camera, mode: str, axis: Vector, angle: float) -> None:
    """Turn the camera by `angle` [rad] about `axis` (its own frame); its position stays."""
    p = camera.pose.p
    q = quat_multiply(unturned(camera, p, mode), axis_angle(axis, angle))
    camera.set_pose(Pose(p, q))
