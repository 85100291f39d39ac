"""The left hand takes a tall block and gives it in the air to the right, which stands it on a pad.

Success: the block's foot is on the pad, nothing holds it, and the right hand is open.
"""

from rtphys.task import (
    BLUE,
    DOWN,
    RED,
    Box,
    Draw,
    Placing,
    Pose,
    Robot,
    Task,
    at_rest,
    free_of,
    opened,
    points_meet,
)

TURNED = 0.3927  # [rad] the block's mean yaw, 22.5 deg
UPPER, LOWER = (0, 1, 2, 3), (4, 5, 6, 7)  # contact points
MEETING = Pose((0.0, 0.0, 0.9), DOWN)  # of the block's foot, where both hands reach
APPROACH, LIFT, RETREAT = 0.07, 0.1, 0.1  # [m] straight on to the block; up; off it
OFFER = Placing(mode="free", pre=0.0, gap=0.0, release=False)
STAND = Placing(mode="align", pre=0.05, gap=0.0, along="point")


def layout(draw: Draw):
    yaw = (TURNED - 0.2, TURNED + 0.2)
    spot = draw.spot("block", x=(-0.25, -0.05), y=(0.0, 0.25), yaw=yaw)
    yield Box(
        name="block", half_size=(0.03, 0.03, 0.1), colour=RED, pose=spot.pose(),
        upright_grasps=True, phrase="red block",
    )  # fmt: skip
    pad = draw.spot("pad", x=(0.1, 0.25), y=(0.15, 0.2))
    yield Box(
        name="pad", half_size=(0.05, 0.05, 0.005), colour=BLUE, pose=pad.pose(), fixed=True,
        phrase="blue pad",
    )  # fmt: skip


def script(robot: Robot) -> None:
    giver, taker = robot.left, robot.right
    robot.do(giver.grasp("block", UPPER, pre=APPROACH))
    robot.do(giver.lift(LIFT))
    robot.do(giver.place("block", MEETING, point=0, how=OFFER))
    robot.do(taker.grasp("block", LOWER, pre=APPROACH))
    robot.do(giver.open())
    robot.do(giver.retreat(RETREAT))
    pad = robot.scene.functional("pad", 1)
    robot.do(taker.place("block", pad, point=0, how=STAND), giver.home())


task = Task(
    layout=layout,
    script=script,
    success=points_meet("block", 0, "pad", 1, within=(0.03, 0.03, 0.01))
    & opened("right")
    & free_of("block", "left_gripper", "right_gripper")
    & at_rest("block"),
    step_limit=800,
    keep_clear=(((-0.2, 0.2), (-0.25, 0.0)), ((-0.35, 0.35), (-0.1, 0.25))),  # level hands
    arms="dual, in sequence",
    mechanism="handover, place",
)
