"""Put a pair of shoes side by side into the shoe box, toes to the left.

Success: each shoe stands in its half of the box, turned as it should be, and both hands are open.
"""

import numpy as np

from rtphys.task import (
    TABLE_TOP,
    UP_S,
    UP_Z,
    Aim,
    Draw,
    Mesh,
    Placing,
    Pose,
    Robot,
    Scene,
    Spot,
    Task,
    at_rest,
    clear_of,
    condition,
    hands_open,
    near,
    reachable,
    turned_to,
)

BOX = Pose((0.0, -0.13, TABLE_TOP), UP_S)
BESIDE, BEHIND = 0.14, -0.03  # [m] |x| and y from which a shoe is clear of the box
HALF_LENGTH, HALF_WIDTH = 0.12, 0.045  # [m] of the largest shoe
CENTRE = ((0.0, 0.0), 0.15)  # kept free at the start: a point and a distance [m]
FLOOR = (-0.01, 0.03)  # [m] of a sole that is on the box's floor, above the box's origin
INTO = Placing(mode="align", pre=0.12, gap=0.015, along="point")
LIFT, RETREAT = 0.15, 0.1  # [m] over the box's wall; up from the second shoe
TURN = 0.17  # [rad] officially 0.07 in each component of the quaternion


def room(spot: Spot) -> bool:
    """Far from the table's centre, the shoe beside the box or behind it (not in upstream)."""
    across, along = abs(np.sin(spot.yaw)), abs(np.cos(spot.yaw))
    beside = abs(spot.x) - HALF_LENGTH * across - HALF_WIDTH * along > BESIDE
    behind = spot.y - HALF_LENGTH * along - HALF_WIDTH * across > BEHIND
    return clear_of(CENTRE)(spot) and reachable(spot) and (beside or behind)


def layout(draw: Draw):
    yield Mesh(name="box", category="007_shoe-box", model=0, pose=BOX, fixed=True)
    model = draw.choice("model", *range(10))
    for side, x in (("left", (-0.3, -0.225)), ("right", (0.225, 0.3))):
        spot = draw.spot(side, x=x, y=(-0.1, 0.05), yaw=(-3.14, 3.14), where=room)
        pose = spot.pose(UP_Z)
        yield Mesh(name=f"{side}_shoe", category="041_shoe", model=model, pose=pose)


def on_the_floor(scene: Scene) -> bool:
    """Both soles on the floor of the box."""
    box, (low, high) = scene.pose("box").p[2], FLOOR
    return all(low < scene.lowest(f"{side}_shoe") - box < high for side in ("left", "right"))


def script(robot: Robot) -> None:
    left, right, scene = robot.left, robot.right, robot.scene
    places = scene.functional("box", 0), scene.functional("box", 1)
    robot.do(
        left.grasp("left_shoe", aim=Aim(places[0], 0, INTO)),
        right.grasp("right_shoe", aim=Aim(places[1], 0, INTO)),
    )
    robot.do(left.lift(LIFT), right.lift(LIFT))
    robot.do(left.place("left_shoe", places[0], point=0, how=INTO))
    robot.do(left.lift(LIFT))
    robot.do(left.home(), right.place("right_shoe", places[1], point=0, how=INTO))
    robot.do(right.lift(RETREAT))


task = Task(
    layout=layout,
    script=script,
    success=near("left_shoe", (0.0, -0.17, TABLE_TOP + 0.01), within=(0.05, 0.05, 0.03))
    & near("right_shoe", (0.0, -0.09, TABLE_TOP + 0.01), within=(0.05, 0.05, 0.03))
    & turned_to("left_shoe", UP_S, TURN)
    & turned_to("right_shoe", UP_S, TURN)
    & condition("both shoes on the floor of the box", on_the_floor)
    & at_rest("left_shoe")
    & at_rest("right_shoe")
    & hands_open(),
    step_limit=600,
    arms="dual, in sequence",
    mechanism="place two",
    table_drop=0.1,
    info={"A": "left_shoe", "B": "box"},
)
