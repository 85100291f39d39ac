"""Turn the payment sign round so that its code faces the robot.

Success: the sign stands on the table, at rest, turned to the robot, and both hands are open.
"""

from dataclasses import replace

from rtphys.task import (
    IDENTITY,
    TABLE_TOP,
    UP_F,
    UP_Z,
    Aim,
    Arm,
    Draw,
    Mesh,
    Placing,
    Pose,
    Robot,
    Task,
    at_rest,
    hands_open,
    off_centre,
    on_table,
    turned_to,
)

FACING = Placing(mode="align", pre=0.07, gap=0.005)
# Where the whole turn is out of reach: a part of it, and the rest from a second grasp.
PARTLY = replace(FACING, yaws=(1.2, -1.2, 1.6, -1.6, 0.8, -0.8, 2.0, -2.0))
GRASPS = 2  # at most
OUT, BACK = 0.08, -0.22  # [m] |x| and y of a place where the hand can point back at the robot
APPROACH, LIFT, RETREAT = 0.05, 0.07, 0.06  # [m] before the grasp; to carry; back from the sign
ENOUGH = 0.1  # [rad] officially 0.05 in each component of the quaternion


def layout(draw: Draw):
    spot = draw.spot(
        "sign", x=(-0.25, 0.25), y=(-0.2, 0.0), yaw=(-0.7, 0.7), where=off_centre(0.05)
    )
    model, pose = draw.choice("model", *range(4)), spot.pose(UP_F)
    yield Mesh(name="sign", category="070_paymentsign", model=model, pose=pose)


def target(arm: Arm) -> Pose:
    """The sign close to the robot, on the arm's own side, turned to the robot."""
    return Pose((-OUT if arm.side == "left" else OUT, BACK, TABLE_TOP), IDENTITY)


def turn(robot: Robot, arm: Arm, how: Placing) -> None:
    robot.do(arm.place("sign", target(arm), how=how))
    robot.do(arm.retreat(RETREAT))


def script(robot: Robot) -> None:
    arm = robot.nearest("sign")
    for _ in range(GRASPS):
        robot.do(arm.grasp("sign", pre=APPROACH, aim=Aim(target(arm), None, FACING)))
        robot.do(arm.lift(LIFT))
        if robot.tried(lambda: turn(robot, arm, FACING)):
            return
        turn(robot, arm, PARTLY)


task = Task(
    layout=layout,
    script=script,
    success=turned_to("sign", UP_Z, within=ENOUGH)
    & on_table("sign")
    & at_rest("sign")
    & hands_open(),
    step_limit=400,
    mechanism="turn, place",
    info={"A": "sign", "a": "arm:sign"},
)
