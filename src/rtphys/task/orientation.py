"""Orientations in which assets stand, as wxyz quaternions.

Official models are y-up in their own frame; each constant says where the model's x, y, z go, in
the task frame: +x is the robot's right, +y away from it, +z up. UP_Y is RoboTwin's most frequent.
"""

from rtphys.core.poses import Array, axis_angle, quat_multiply

IDENTITY = (1.0, 0.0, 0.0, 0.0)
UP_Y = (0.5, 0.5, 0.5, 0.5)  # x -> +y, y -> up, z -> +x
UP_Z = (0.7071067811865476, 0.7071067811865476, 0.0, 0.0)  # x -> +x, y -> up, z -> -y
UP_F = (0.0, 0.0, 0.7071067811865476, 0.7071067811865476)  # x -> -x, y -> up, z -> +y
UP_S = (0.5, 0.5, -0.5, -0.5)  # x -> -y, y -> up, z -> -x
DOWN = (0.0, 1.0, 0.0, 0.0)  # x -> +x, y -> -y, z -> down: a target seen by a tool pointing down


def yawed(q: tuple[float, ...] | Array, yaw: float) -> Array:
    """`q` turned by `yaw` [rad] about the vertical, (4,)."""
    return quat_multiply(axis_angle((0, 0, 1), yaw), q)
