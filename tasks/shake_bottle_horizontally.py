"""Lift a lying bottle and shake it while it lies level in the hand.

Success: the lying bottle went up and down three times by 3 cm, in the air, and is then level
within 20 deg and in a hand. Upstream tests that the bottle was lifted; the shaking and the
attitude are what the name demands.
"""

from itertools import product
from math import pi

import numpy as np

from rtphys.task import (
    Condition,
    Draw,
    Pose,
    Robot,
    Scene,
    Task,
    axis_angle,
    condition,
    in_either_hand,
    quat_multiply,
)

from ._shaken_bottle import (
    APPROACH,
    DEPTH,
    LIFT,
    OUT,
    TILT,
    lying_bottle,
    shaken_in_air,
    up_and_down,
)

SPINS = (pi / 2, pi / 3, pi / 4, 0.4, 0.0)  # [rad] from a hand above to a level one
HEIGHTS = (0.95, 1.0)  # [m] of the bottle's middle, at the bottom of the shaking
HEADINGS = (0.0, 0.4, -0.4, 0.8, -0.8, pi / 2)  # [rad] of its top, from x


def layout(draw: Draw):
    yield lying_bottle(draw)


def shakes(scene: Scene, centre: tuple[float, float, float], yaw: float, spin: float) -> list[Pose]:
    """Poses of the bottle: level, shaken across its own axis, level.

    Args:
        centre: of the bottle's middle [m].
        yaw: turn about the vertical, away from where the top points now [rad].
        spin: turn about the bottle's own axis, which brings the hand from above to behind it [rad].
    """
    now, middle = scene.pose("bottle"), scene.functional("bottle").p
    turned = quat_multiply(axis_angle((0, 0, 1), yaw), now.q)
    axis = Pose((0, 0, 0), turned).R[:, 1]
    level = Pose(centre, quat_multiply(axis_angle(axis, spin), turned))
    across = np.cross((0, 0, 1), axis)
    leaning = [quat_multiply(axis_angle(across, tilt), level.q) for tilt in (TILT, -TILT)]
    X_MB = Pose(middle, now.q).inverse() @ now
    return [X_WM @ X_MB for X_WM in up_and_down(level, *leaning)]


def lying(within: float) -> Condition:
    """The bottle's axis within an angle [rad] of level."""
    return condition(
        f"the bottle lies level within {within:.2f} rad",
        lambda s: bool(abs(s.pose("bottle").R[2, 1]) < np.sin(within)),
    )


def script(robot: Robot) -> None:
    arm = robot.nearest("bottle")
    robot.do(arm.grasp("bottle", pre=APPROACH))
    robot.do(arm.lift(LIFT))
    x, top = -OUT if arm.side == "left" else OUT, robot.scene.pose("bottle").R[:, 1]
    now = float(np.arctan2(top[1], top[0]))
    paths = [
        shakes(robot.scene, (x, DEPTH, z), heading - now, spin)
        for spin, z, heading in product(SPINS, HEIGHTS, HEADINGS)
    ]
    robot.do(arm.carry("bottle", *paths))


task = Task(
    layout=layout,
    script=script,
    success=shaken_in_air(lying(0.7)) & lying(0.35) & in_either_hand("bottle"),
    step_limit=700,
    mechanism="lift, shake",
    info={"A": "bottle", "a": "arm:bottle"},
)
