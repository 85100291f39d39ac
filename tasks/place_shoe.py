"""Put a shoe on the blue mat, toe to the left.

Success: the shoe stands on the mat's middle, turned as it should be, at rest, and both hands are
open. Upstream does not test the height.
"""

from math import pi

from rtphys.task import (
    BLUE,
    DOWN,
    TABLE_TOP,
    UP_S,
    UP_Z,
    Aim,
    Box,
    Draw,
    Mesh,
    Placing,
    Pose,
    Robot,
    Spot,
    Task,
    at_rest,
    clear_of,
    hands_open,
    near,
    on_table,
    reachable,
    turned_to,
    yawed,
)

MAT = (0.0, -0.08)  # [m]
ROOM = 0.15  # [m] about the mat and the table's centre, where no shoe starts
TURN = 0.17  # [rad] officially 0.07 in each component of the quaternion
STAND = Placing(mode="align", pre=0.06, gap=0.012, along="point")
LIFT, RETREAT = 0.07, 0.08  # [m] to carry the shoe; back from it once it is released


def room(spot: Spot) -> bool:
    return clear_of(((0.0, 0.0), ROOM), (MAT, ROOM))(spot) and reachable(spot)


def layout(draw: Draw):
    yield Box(
        name="mat", half_size=(0.13, 0.05, 0.0005), colour=BLUE, pose=Spot(*MAT).pose(),
        fixed=True, phrase="blue mat",
    )  # fmt: skip
    spot = draw.spot("shoe", x=(-0.25, 0.25), y=(-0.1, 0.05), yaw=(-pi, pi), where=room)
    model = draw.choice("model", *range(10))
    yield Mesh(name="shoe", category="041_shoe", model=model, pose=spot.pose(UP_Z))


def script(robot: Robot) -> None:
    arm = robot.nearest("shoe")
    # A sole's frame in UP_S: x towards the robot, z down.
    mat = Pose(robot.scene.functional("mat", 1).p, yawed(DOWN, -pi / 2))
    robot.do(arm.grasp("shoe", aim=Aim(mat, 0, STAND)))
    robot.do(arm.lift(LIFT))
    robot.do(arm.place("shoe", mat, point=0, how=STAND))
    robot.do(arm.retreat(RETREAT))


task = Task(
    layout=layout,
    script=script,
    success=near("shoe", (*MAT, TABLE_TOP), within=(0.05, 0.02, 0.03))
    & turned_to("shoe", UP_S, TURN)
    & on_table("shoe")
    & at_rest("shoe")
    & hands_open(),
    step_limit=500,
    mechanism="place: aligned",
    info={"A": "shoe", "a": "arm:shoe"},
)
