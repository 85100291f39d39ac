"""Turn the payment sign round so that its code faces the robot.

Success: the sign stands on the table, at rest, turned to the robot, and both hands are open.
"""

from dataclasses import replace

from rtphys.task import (
    IDENTITY,
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
PARTLY = replace(FACING, yaws=(1.2, -1.2, 1.6, -1.6, 0.8, -0.8, 2.0, -2.0))
ENOUGH = 0.1  # [rad] 0.05 in each entry of the quaternion


def layout(draw: Draw):
    spot = draw.spot(
        "sign", x=(-0.25, 0.25), y=(-0.2, 0.0), yaw=(-0.7, 0.7), where=off_centre(0.05)
    )
    model, pose = draw.choice("model", *range(4)), spot.pose(UP_F)
    yield Mesh(name="sign", category="070_paymentsign", model=model, pose=pose)


def turn(robot: Robot, arm: Arm, how: Placing) -> None:
    robot.do(arm.place("sign", near_by(arm), how=how))
    robot.do(arm.retreat(0.06))


def script(robot: Robot) -> None:
    arm = robot.nearest("sign")
    for _ in range(2):
        robot.do(arm.grasp("sign", pre=0.05, aim=Aim(near_by(arm), None, FACING)))
        robot.do(arm.lift(0.07))
        if robot.tried(lambda: turn(robot, arm, FACING)):
            return
        turn(robot, arm, PARTLY)


def near_by(arm: Arm) -> Pose:
    """Close to the robot, where a hand can point back at it."""
    return Pose((-0.08 if arm.side == "left" else 0.08, -0.22, 0.74), IDENTITY)


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
