"""Lift a block and lean it to both sides in the hand: where is its middle, and does it turn?

Success: the block was leant both ways and is still in the hand, in the air.
"""

from rtphys.task import (
    Draw,
    Robot,
    Scene,
    Task,
    axis_angle,
    condition,
    in_either_hand,
    lifted,
    quat_multiply,
)

from ._right_hand import block, lift_block

LEAN = 0.5  # [rad] to either side, about the robot's own forward axis
COUNTS = 0.35  # [rad] of the hand
HOLD = 0.6  # [s] in each attitude


def layout(draw: Draw):
    yield block(draw)


def leant(scene: Scene) -> bool:
    side = float(scene.tcp("right").R[0, 0])  # of the approach direction along the table
    held = scene.touching("right_gripper", "block")
    one = scene.once("leant to the left", held and side < -COUNTS)
    other = scene.once("leant to the right", held and side > COUNTS)
    return one and other


def script(robot: Robot) -> None:
    arm = lift_block(robot)
    level = arm.ee().q
    for angle in (LEAN, -LEAN):
        turned = quat_multiply(axis_angle((0, 1, 0), angle), level)
        robot.do(arm.shift(turn=tuple(turned.tolist())))
        robot.do(arm.wait(HOLD))


task = Task(
    layout=layout,
    script=script,
    success=condition("the block was leant both ways", leant, remembers=True)
    & lifted("block", 0.02)
    & in_either_hand("block"),
    step_limit=300,
    mechanism="probe",
    info={"A": "block", "a": "right"},
)
