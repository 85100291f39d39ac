"""Of two plates that look alike, put the slippery one into the box.

Success: the slippery plate is in the box, the other one lies on the table, and both hands are open.
"""

from collections.abc import Mapping

import numpy as np

from rtphys.task import (
    BLUE,
    DOWN,
    UP_Y,
    Box,
    Draw,
    Mesh,
    Placing,
    Pose,
    Robot,
    Scene,
    Task,
    at_rest,
    condition,
    hands_open,
    on_table,
)

from ._hidden import APPROACH, OFF, ranked

PLATES = ("first", "second")
HALF = (0.025, 0.025, 0.01)  # [m]: flat, so that a rough one is rubbed and not overturned
INTO = Placing(mode="free", pre=0.06, gap=0.03, along="point")
LIFT, RETREAT = 0.12, 0.08  # [m] over the box's wall; up from what was put in
INSIDE = 0.06  # [m] of a plate from the box's middle, per axis
OVER, DEEPEST = 0.03, 0.06  # [m] from the fingertips to a plate; the longest way down to it
LEAN = 0.006  # [m] of the commanded tips below the touch
BEFORE, RUB = 0.015, 0.03  # [m] of the tips before the middle at first; across the plate


def layout(draw: Draw):
    box = draw.spot("box", x=(0.0, 0.0), y=(-0.12, -0.08))
    yield Mesh(name="box", category="062_plasticbox", model=3, pose=box.pose(UP_Y), fixed=True)
    sides = draw.shuffled("side", [(-0.27, -0.17), (0.17, 0.27)])
    for name, x in zip(PLATES, sides, strict=True):
        spot = draw.spot(name, x=x, y=(-0.17, -0.07), yaw=(-0.5, 0.5))
        yield Box(name=name, half_size=HALF, colour=BLUE, pose=spot.pose(), mass_kg=0.06)


def in_box(scene: Scene, plate: str) -> bool:
    box, plate_at = scene.pose("box").p, scene.pose(plate).p
    return bool(np.all(np.abs(plate_at - box)[:2] < INSIDE)) and not scene.touching(plate, "table")


def slippery_in_box(scene: Scene) -> bool:
    slippery, rough = ranked(scene, "friction", PLATES)
    return in_box(scene, slippery) and on_table(rough).holds(scene)


def script(robot: Robot) -> None:
    plate, _ = ranked(robot.scene, "friction", PLATES)
    arm = robot.nearest(plate)
    floor = Pose(robot.scene.pose("box").p, DOWN)
    robot.do(arm.grasp(plate, pre=APPROACH))
    robot.do(arm.lift(LIFT))
    robot.do(arm.place(plate, floor, point=0, how=INTO))
    robot.do(arm.lift(RETREAT))


def feel(robot: Robot) -> Mapping[str, float]:
    return {f"friction@{plate}": rubbed(robot, plate) for plate in PLATES}


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
    pressed = forces[forces[:, 2] > 2.0]
    return float(np.median(np.hypot(pressed[:, 0], pressed[:, 1]) / pressed[:, 2]))


task = Task(
    layout=layout,
    script=script,
    feel=feel,
    success=condition("the slippery plate is in the box, the other on the table", slippery_in_box)
    & at_rest(*PLATES)
    & hands_open(),
    step_limit=900,
    mechanism="hidden friction: choose",
)
