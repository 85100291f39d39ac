"""A bottle that lies on the table, is lifted and shaken: upright in one task, level in another."""

from math import pi

import numpy as np

from rtphys.task import TABLE_TOP, Condition, Draw, Mesh, Pose, above, shaken

LYING = (0.0, 0.0, 1.0, 0.0)  # top away from the robot
OUT, DEPTH = 0.15, -0.08  # [m] |x| and y where the bottle is shaken, on the arm's own side
SHAKES, STROKE = 3, 0.05  # times up and down, by so much [m]
TILT = 0.3927  # [rad] by which the bottle leans one way at the top and the other at the bottom
COUNTS = 0.03  # [m] least stroke that counts
APPROACH, LIFT = 0.075, 0.1  # [m] before the grasp; off the table
IN_AIR = above("bottle", TABLE_TOP + 0.06)


def lying_bottle(draw: Draw) -> Mesh:
    sides = [(-0.15, -0.1), (0.1, 0.15)]
    spot = draw.spot("bottle", x=sides, y=(-0.15, -0.05), yaw=(-pi / 4, pi / 4))
    model, pose = draw.choice("model", *range(20)), spot.pose(LYING)
    return Mesh(name="bottle", category="001_bottle", model=model, pose=pose, rolls_about=1)


def up_and_down(start: Pose, leaning_up: np.ndarray, leaning_down: np.ndarray) -> list[Pose]:
    """Poses of the bottle: the start, then up and down with these orientations, then the start."""
    top = Pose(start.moved((0.0, 0.0, STROKE)).p, leaning_up)
    return [start, *[top, Pose(start.p, leaning_down)] * SHAKES, start]


def shaken_in_air(attitude: Condition) -> Condition:
    """The bottle went up and down in the air in that attitude, and is still there."""
    turns = 2 * SHAKES - 1  # at the top and the bottom, without the last return
    return shaken("bottle", COUNTS, turns, during=IN_AIR & attitude) & IN_AIR
