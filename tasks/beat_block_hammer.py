"""Pick up the hammer and strike the red block with its face.

Success: the face meets the block's top within 2 cm, the hammer is in a hand, and the blow was
felt. Upstream tests neither grip nor impact; both are what the name demands.
"""

from dataclasses import replace

from rtphys.task import (
    RED,
    Aim,
    Arm,
    Box,
    Draw,
    Mesh,
    Placing,
    Pose,
    Robot,
    Scene,
    Spot,
    Task,
    clear_of,
    condition,
    in_either_hand,
    off_centre,
    points_meet,
)

LYING = Pose((0.0, -0.06, 0.783), (0.0, 0.0, 0.995, 0.105))  # face down, head away from the robot
STRIKE = 0.001  # [N s] a blow that moves a gram by 1 m/s; resting contact of one step is below it
APPROACH, LIFT = 0.12, 0.07  # [m] straight on to the handle; up before the hammer is aimed
DEPTH = 0.015  # [m] at which the TCP stops short of the handle's contact point
HALF = 0.025  # [m] half the block's edge
RAISED = Placing(pre=0.06, gap=0.06, along="point", release=False)
# A blow, no push: pressed on, the head turns the handle in the hand, against the wrist.
OVER = Placing(pre=0.06, gap=-0.02, along="point", release=False, until="block", lean=0.003)


def layout(draw: Draw):
    yield Mesh(name="hammer", category="020_hammer", model=0, pose=LYING)
    spot = draw.spot("block", x=(-0.25, 0.25), y=(-0.05, 0.15), yaw=(-0.5, 0.5), where=room)
    yield Box(
        name="block", half_size=(HALF, HALF, HALF), colour=RED, pose=spot.pose(), fixed=True,
        phrase="red block",
    )  # fmt: skip


def room(spot: Spot) -> bool:
    """Off the midline, and far enough from the handle that a hand fits between (not upstream's)."""
    return off_centre(0.05)(spot) and clear_of(((0.0, -0.06), 0.115))(spot)


def struck(scene: Scene) -> bool:
    return scene.peak("blow", scene.impulse("hammer", "block")) > STRIKE


def aim(robot: Robot, arm: Arm, how: Placing) -> None:
    """Face flat over the block; a head too heavy for the hand strikes as it hangs."""
    top = robot.scene.functional("block", 1)
    if not robot.tried(lambda: robot.do(arm.place("hammer", top, point=0, how=how))):
        hanging = Pose(top.p, robot.scene.functional("hammer", 0).q)
        robot.do(arm.place("hammer", hanging, point=0, how=replace(how, mode="free")))


def script(robot: Robot) -> None:
    arm, top = robot.nearest("block"), robot.scene.functional("block", 1)
    robot.do(arm.grasp("hammer", pre=APPROACH, depth=DEPTH, aim=Aim(top, 0, OVER)))
    robot.do(arm.lift(LIFT))
    aim(robot, arm, RAISED)
    # A heavy head sags in the hand on the way: aim anew from above the block.
    aim(robot, arm, OVER)


task = Task(
    layout=layout,
    script=script,
    success=points_meet("hammer", 0, "block", 1, within=(0.02, 0.02, 0.02))
    & condition("the block was struck", struck, remembers=True)
    & in_either_hand("hammer"),
    step_limit=400,
    mechanism="tool: strike",
    info={"A": "hammer", "a": "arm:block"},
)
