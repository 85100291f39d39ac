"""Of two plates that look alike, put the slippery one into the box.

Success: the slippery plate is in the box, the other one lies on the table, and both hands are open.
"""

from collections.abc import Mapping

import numpy as np

from rtphys.task import Draw, Robot, Scene, Task, condition

from ._box_between import PAIR, RESTS, box_between, only_in_box, put_in_box
from ._hidden import OFF, ranked

HALF, MASS = (0.025, 0.025, 0.01), 0.06  # [m]: flat, so that it is rubbed and not overturned; [kg]
GAP = 0.03  # [m] above the box's floor where it is let go
OVER, DEEPEST = 0.03, 0.06  # [m] from the fingertips to a plate; the longest way down to it
LEAN = 0.006  # [m] of the commanded tips below the touch
BEFORE, RUB = 0.015, 0.03  # [m] of the tips before the middle at first; across the plate
PRESSED = 2.0  # [N] from which a frame counts


def layout(draw: Draw):
    yield from box_between(draw, HALF, MASS)


def slippery_in_box(scene: Scene) -> bool:
    return only_in_box(scene, *ranked(scene, "friction", PAIR))


def script(robot: Robot) -> None:
    put_in_box(robot, ranked(robot.scene, "friction", PAIR)[0], GAP)


def feel(robot: Robot) -> Mapping[str, float]:
    return {f"friction@{plate}": rubbed(robot, plate) for plate in PAIR}


def rubbed(robot: Robot, plate: str) -> float:
    """Coefficient between a plate and the closed fingertips that are drawn across it."""
    arm = robot.nearest(plate)
    robot.do(arm.close())
    robot.do(arm.hover(plate, gap=arm.hand.fingertip + OVER, straight_down=True))
    robot.do(arm.shift(y=-BEFORE))
    robot.do(arm.press(plate, DEEPEST, LEAN))
    robot.do(arm.shift(y=RUB))
    forces = arm.felt()[:, :3]
    robot.do(arm.lift(OFF))
    robot.do(arm.home(), arm.open())
    pressed = forces[forces[:, 2] > PRESSED]
    return float(np.median(np.hypot(pressed[:, 0], pressed[:, 1]) / pressed[:, 2]))


task = Task(
    layout=layout,
    script=script,
    feel=feel,
    success=condition("the slippery plate is in the box, the other on the table", slippery_in_box)
    & RESTS,
    step_limit=900,
    mechanism="hidden friction: choose",
)
