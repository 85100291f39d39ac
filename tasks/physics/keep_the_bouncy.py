"""Of two cubes that look alike, put the one that bounces into the box.

Success: the bouncy cube is in the box, the other one lies on the table, and both hands are open.
"""

from collections.abc import Mapping

import numpy as np

from rtphys.task import Draw, Robot, Scene, Task, condition

from ._box_between import PAIR, RESTS, box_between, only_in_box, put_in_box
from ._hidden import APPROACH, OFF, ranked

HALF, MASS = (0.018, 0.018, 0.018), 0.04  # [m], [kg]
GAP = 0.005  # [m] above the box's floor where it is let go
DROP = 0.07  # [m] from which a cube is let fall
REST = 0.6  # [s] for it to come to rest
NEAR = 0.02  # [m] of a cube above where it comes to rest: it meets the table within a frame


def layout(draw: Draw):
    yield from box_between(draw, HALF, MASS)


def bouncy_in_box(scene: Scene) -> bool:
    return only_in_box(scene, *reversed(ranked(scene, "restitution", PAIR)))


def script(robot: Robot) -> None:
    put_in_box(robot, ranked(robot.scene, "restitution", PAIR)[1], GAP)


def feel(robot: Robot) -> Mapping[str, float]:
    return {f"restitution@{cube}": dropped(robot, cube) for cube in PAIR}


def dropped(robot: Robot, cube: str) -> float:
    """Coefficient of restitution from how high a cube bounces that is let fall."""
    arm = robot.nearest(cube)
    robot.do(arm.grasp(cube, pre=APPROACH))
    robot.do(arm.lift(DROP))
    top = robot.scene.pose(cube).p[2]
    robot.do(arm.open().then(arm.wait(REST)))
    heights = robot.seen(cube)[:, 2]
    low = heights[-1]
    first = int(np.argmax(heights < low + NEAR)) + 1  # in the frame before, it may still fall
    robot.do(arm.lift(OFF))
    robot.do(arm.home())
    bounced = float(max(heights[first:].max() - low, 0.0))
    return (bounced / max(top - low, 1e-3)) ** 0.5


task = Task(
    layout=layout,
    script=script,
    feel=feel,
    success=condition("the bouncy cube is in the box, the other on the table", bouncy_in_box)
    & RESTS,
    step_limit=900,
    mechanism="hidden restitution: choose",
)
