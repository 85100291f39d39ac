"""Put the fan on the coloured pad, facing the robot.

Success: the fan stands on the pad's middle, faces the robot, at rest, and both hands are open.
"""

from math import pi

import numpy as np

from rtphys.task import (
    IDENTITY,
    UP_F,
    UP_Z,
    Aim,
    Draw,
    Mesh,
    Placing,
    Pose,
    Robot,
    Task,
    at_rest,
    hands_open,
    near,
    off_centre,
    on_table,
    turned_to,
)

from ._pads import coloured_pad

TURN = 0.12  # [rad] officially 0.05 in each component of the quaternion
FACING = Placing(mode="align", pre=-0.06, gap=-0.004, along="point")  # the pad's z points up
APPROACH, LIFT, RETREAT = 0.05, 0.05, 0.06  # [m] before the grasp; to carry; up from the fan


def layout(draw: Draw):
    fan = draw.spot("fan", x=(-0.1, 0.1), y=(-0.15, -0.05), yaw=(-pi, pi), where=off_centre(0.01))
    model = draw.choice("model", 4, 5)
    yield Mesh(name="fan", category="099_fan", model=model, pose=fan.pose(UP_F))
    side = (0.15, 0.25) if fan.x > 0 else (-0.25, -0.15)
    pad = draw.spot("pad", x=side, y=(-0.15, -0.05), where=lambda s: s.distance(fan) > 0.13)
    yield coloured_pad(draw, pad, (0.05, 0.05, 0.001))


def script(robot: Robot) -> None:
    arm = robot.nearest("fan")
    height = robot.scene.pose("fan").p[2] - robot.scene.lowest("fan")
    pad = Pose(robot.scene.functional("pad", 1).p + np.array([0, 0, height]), IDENTITY)
    robot.do(arm.grasp("fan", pre=APPROACH, aim=Aim(pad, None, FACING)))
    robot.do(arm.lift(LIFT))
    robot.do(arm.place("fan", pad, how=FACING))
    robot.do(arm.lift(RETREAT))


task = Task(
    layout=layout,
    script=script,
    success=near("fan", "pad", within=(0.04, 0.04, 0.04))
    & turned_to("fan", UP_Z, TURN)
    & on_table("fan")
    & at_rest("fan")
    & hands_open(),
    step_limit=400,
    mechanism="place: aligned",
    info={"A": "fan", "B": "pad", "a": "arm:fan"},
)
