"""Lift a beam level with both hands: its load is hidden, and a hand that bears most of it slips.

Success: the beam is in both hands, level, and 6 cm above the table.
"""

from collections.abc import Mapping

import numpy as np

from rtphys.task import (
    BLUE,
    TABLE_TOP,
    Arm,
    Box,
    Draw,
    Motion,
    Pose,
    Robot,
    Scene,
    Task,
    condition,
    held_by,
    lifted,
)

HALF = (0.24, 0.0125, 0.0125)  # [m] of the beam
MASS = 1.7  # [kg]: a hand slips that bears two thirds of it with this friction
APART = 0.11  # [m] of each hand from the load
PRE, LOW = 0.08, 0.004  # [m] above the grasp, before it; of the fingertips above the table
RISE = 0.09  # [m] the beam is lifted
NUDGE, HIGHEST = 0.005, 0.03  # [m] that hands go up at a time, and at most, to feel the load
TRIES, TILTS = 4, 0.008  # of finding the load; sine of the tilt that says which end is loaded
FARTHEST = 0.1  # [m] of the load from the middle
HOLD = 0.16  # [s]
LEVEL = 0.07  # sine of the beam's tilt, at most


def layout(draw: Draw):
    spot = draw.spot("beam", x=(-0.03, 0.03), y=(-0.19, -0.13), yaw=(-0.15, 0.15))
    yield Box(name="beam", half_size=HALF, colour=BLUE, mass_kg=MASS, pose=spot.pose())


def level(scene: Scene) -> bool:
    return abs(float(scene.pose("beam").R[2, 0])) < LEVEL


def take(robot: Robot, arm: Arm, x: float) -> Motion:
    """Grasp the beam from above, `x` [m] from its middle."""
    beam = robot.scene.pose("beam")
    down, across = np.array([0.0, 0.0, -1.0]), beam.R[:, 1] * (1.0, 1.0, 0.0)
    across /= np.linalg.norm(across)
    turned = Pose.from_matrix(np.column_stack([down, across, np.cross(down, across)])).q
    place = beam @ np.array([x, 0.0, 0.0])
    at = Pose((place[0], place[1], TABLE_TOP + LOW + arm.hand.tip), turned)
    before = arm.reach(at.moved((0.0, 0.0, PRE)))
    return before.then(arm.line(at)).then(arm.close(holds="beam"))


def script(robot: Robot) -> None:
    left, right = robot.left, robot.right
    load = robot.scene.physics.vector("center_of_mass@beam")[0]
    robot.do(take(robot, left, load - APART), take(robot, right, load + APART))
    robot.do(left.shift(z=RISE), right.shift(z=RISE))


def feel(robot: Robot) -> Mapping[str, tuple[float, ...]]:
    """Raise both hands until one end leaves the table: the load is on the other side of them."""
    left, right = robot.left, robot.right
    low, high = -FARTHEST, FARTHEST
    for _ in range(TRIES):
        load = (low + high) / 2
        robot.do(take(robot, left, load - APART), take(robot, right, load + APART))
        risen = tilt = 0.0
        while risen < HIGHEST and abs(tilt) < TILTS:
            robot.do(left.shift(z=NUDGE), right.shift(z=NUDGE))
            robot.do(left.wait(HOLD), right.wait(HOLD))
            risen, tilt = risen + NUDGE, float(robot.scene.pose("beam").R[2, 0])
        robot.do(left.shift(z=-risen), right.shift(z=-risen))
        robot.do(left.open(), right.open())
        robot.do(left.shift(z=PRE), right.shift(z=PRE))
        low, high = (load, high) if tilt < 0 else (low, load)
    return {"center_of_mass@beam": ((low + high) / 2, 0.0, 0.0)}


task = Task(
    layout=layout,
    script=script,
    feel=feel,
    success=lifted("beam", 0.06)
    & held_by("beam", "left", "right")
    & condition("the beam is level", level),
    step_limit=800,
    arms="dual, in step",
    mechanism="hidden centre of mass: lift",
)
