"""Displacements of the head camera: orbit about its gaze point, straight shift, or rotation."""

from typing import Literal

import numpy as np

from rtphys.core.poses import Array, Pose, axis_angle, quat_multiply, rotation_between
from rtphys.physics.handles import Camera
from rtphys.physics.values import Vector

Mode = Literal["orbit", "shift", "rotate"]
MODES: tuple[Mode, ...] = ("orbit", "shift", "rotate")


def gaze_point(camera: Camera) -> Array:
    """Point (3,) where the nominal optical axis meets the nominal table top, world frame [m]."""
    nominal = camera.nominal_pose
    return nominal.p + nominal.R @ np.array([camera.range_to_table, 0.0, 0.0])


def unturned(camera: Camera, p: Array, mode: str) -> Array:
    """Orientation wxyz (4,) of a camera at `p` that `camera_angle` has not turned.

    In mode orbit it is the smallest turn from nominal that keeps the gaze point in the middle of
    the picture; in the other modes it is the nominal orientation.
    """
    nominal = camera.nominal_pose
    if mode != "orbit":
        return nominal.q
    gaze = gaze_point(camera)
    return quat_multiply(rotation_between(gaze - nominal.p, gaze - p), nominal.q)


def displaced(camera: Camera, mode: str, direction: Vector, distance: float) -> Array:
    """Camera position (3,) at `distance` [m] from the nominal one, world frame.

    `direction` is a unit vector in the camera frame. A shift follows it. An orbit follows its
    component across the optical axis on the sphere about the gaze point: the range to that point
    stays, and the straight line between old and new position (the chord) is `distance` long.
    """
    nominal = camera.nominal_pose
    if mode != "orbit":
        return nominal.p + distance * (nominal.R @ np.asarray(direction))
    across = np.array([0.0, direction[1], direction[2]])
    if np.linalg.norm(across) < 1e-9:  # parallel to the optical axis: any direction across will do
        across = np.array([0.0, 1.0, 0.0])
    across /= np.linalg.norm(across)
    r = camera.range_to_table
    angle = 2 * np.arcsin(distance / (2 * r))
    return nominal.p + nominal.R @ (r * (np.sin(angle) * across + [1 - np.cos(angle), 0, 0]))


def turn(camera: Camera, mode: str) -> Array:
    """Rotation wxyz (4,) from the unturned camera's frame to the camera's frame now."""
    w, x, y, z = unturned(camera, camera.pose.p, mode)
    return quat_multiply((w, -x, -y, -z), camera.pose.q)


def angle_of(q: Array) -> float:
    """Rotation angle of a quaternion [rad], by atan2: arccos is inexact at small angles."""
    return float(2 * np.arctan2(np.linalg.norm(q[1:]), abs(q[0])))


def move(camera: Camera, mode: str, direction: Vector, distance: float) -> None:
    """Move the camera to `distance` [m] from its nominal position; its rotation stays."""
    rotation = turn(camera, mode)
    p = displaced(camera, mode, direction, distance)
    camera.set_pose(Pose(p, quat_multiply(unturned(camera, p, mode), rotation)))


def turn_by(camera: Camera, mode: str, axis: Vector, angle: float) -> None:
    """Rotate the camera by `angle` [rad] about `axis` (in its own frame); its position stays."""
    p = camera.pose.p
    q = quat_multiply(unturned(camera, p, mode), axis_angle(axis, angle))
    camera.set_pose(Pose(p, q))
