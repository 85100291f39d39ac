"""Of two cubes that look alike, put the one that bounces into the box.

Success: the bouncy cube is in the box, the other one lies on the table, and both hands are open.
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

CUBES = ("first", "second")
HALF = (0.018, 0.018, 0.018)  # [m]
INTO = Placing(mode="free", pre=0.06, gap=0.005, along="point")
LIFT, RETREAT = 0.12, 0.08  # [m] over the box's wall; up from what was put in
INSIDE = 0.06  # [m] of a cube from the box's middle, per axis
DROP = 0.07  # [m] from which a cube is let fall
REST = 0.6  # [s] for it to come to rest
NEAR = 0.02  # [m] of a cube above where it comes to rest: it meets the table within a frame


def layout(draw: Draw):
    box = draw.spot("box", x=(0.0, 0.0), y=(-0.12, -0.08))
    yield Mesh(name="box", category="062_plasticbox", model=3, pose=box.pose(UP_Y), fixed=True)
    sides = draw.shuffled("side", [(-0.27, -0.17), (0.17, 0.27)])
    for name, x in zip(CUBES, sides, strict=True):
        spot = draw.spot(name, x=x, y=(-0.17, -0.07), yaw=(-0.5, 0.5))
        yield Box(name=name, half_size=HALF, colour=BLUE, pose=spot.pose(), mass_kg=0.04)


def in_box(scene: Scene, cube: str) -> bool:
    box, cube_at = scene.pose("box").p, scene.pose(cube).p
    return bool(np.all(np.abs(cube_at - box)[:2] < INSIDE)) and not scene.touching(cube, "table")


def bouncy_in_box(scene: Scene) -> bool:
    dull, bouncy = ranked(scene, "restitution", CUBES)
    return in_box(scene, bouncy) and on_table(dull).holds(scene)


def script(robot: Robot) -> None:
    _, cube = ranked(robot.scene, "restitution", CUBES)
    arm = robot.nearest(cube)
    floor = Pose(robot.scene.pose("box").p, DOWN)
    robot.do(arm.grasp(cube, pre=APPROACH))
    robot.do(arm.lift(LIFT))
    robot.do(arm.place(cube, floor, point=0, how=INTO))
    robot.do(arm.lift(RETREAT))


def feel(robot: Robot) -> Mapping[str, float]:
    return {f"restitution@{cube}": dropped(robot, cube) for cube in CUBES}


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
    & at_rest(*CUBES)
    & hands_open(),
    step_limit=900,
    mechanism="hidden restitution: choose",
)
