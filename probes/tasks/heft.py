"""Lift a block and hold it still: how heavy is it, and where is its middle?

Success: the block is in the hand, in the air.
"""

from rtphys.task import Draw, Robot, Task, in_either_hand, lifted

from ._right_hand import block, lift_block

HOLD = 1.0  # [s] until arm and load are at rest


def layout(draw: Draw):
    yield block(draw)


def script(robot: Robot) -> None:
    arm = lift_block(robot)
    robot.do(arm.wait(HOLD))


task = Task(
    layout=layout,
    script=script,
    success=lifted("block", 0.04) & in_either_hand("block"),
    step_limit=200,
    mechanism="probe",
    info={"A": "block", "a": "right"},
)
