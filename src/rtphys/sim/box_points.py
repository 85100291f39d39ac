"""Where a plain box may be grasped and used (RoboTwin's fact sheet, section 1.4)."""

import numpy as np

from rtphys.core.poses import Pose, axis_angle, quat_multiply
from rtphys.task.props import Box


def box_points(prop: Box, scale: float) -> tuple[list[Pose], list[Pose]]:
    """Contact and functional points of a box, in its frame."""
    hz = prop.half_size[2] * scale
    down = (0.0, 1.0, 0.0, 0.0)
    functional = [Pose((0, 0, -hz), down), Pose((0, 0, hz), down)]
    # Contact frame for a top-down approach: +y (outward) is the box's z, x is camera-up.
    upward = Pose.from_matrix(np.array([[0, 0, 1], [1, 0, 0], [0, 1, 0]], float)).q
    if not prop.upright_grasps:
        turns = [axis_angle((0, 0, 1), k * np.pi / 2) for k in range(4)]
        return [Pose((0, 0, 0), quat_multiply(t, upward)) for t in turns], functional
    # Horizontal: +y outward along box x, x (camera-up) along box z.
    sideways = Pose.from_matrix(np.array([[0, 1, 0], [0, 0, 1], [1, 0, 0]], float)).q
    contacts = [
        Pose((0, 0, level * hz), quat_multiply(axis_angle((0, 0, 1), k * np.pi / 2), sideways))
        for level in (0.7, -0.7)
        for k in range(4)
    ]
    return contacts, functional
