"""Lift a block and shake it up and down: how much does it resist?

Success: the block went up and down twice in the air and is still in the hand.
"""

from rtphys.task import Draw, Robot, Task, in_either_hand, lifted, shaken

from ._right_hand import block, lift_block

STROKE, TIMES = 0.04, 3  # [m], up and down
COUNTS = 0.02  # [m] least stroke that counts
HOLD = 0.5  # [s] at rest, before and after

IN_AIR = lifted("block", 0.02)


def layout(draw: Draw):
    yield block(draw)


def script(robot: Robot) -> None:
    arm = lift_block(robot)
    robot.do(arm.wait(HOLD))
    up, down = arm.shift(z=STROKE), arm.shift(z=-STROKE)
    motion = up.then(down)
    for _ in range(TIMES - 1):
        motion = motion.then(up).then(down)
    robot.do(motion)
    robot.do(arm.wait(HOLD))


task = Task(
    layout=layout,
    script=script,
    success=shaken("block", COUNTS, 4, during=IN_AIR) & IN_AIR & in_either_hand("block"),
    step_limit=300,
    mechanism="probe",
    info={"A": "block", "a": "right"},
)
