"""Lift a rolling pin with both hands.

Success: both hands press on the roller, closed, and it is 6 cm above the table. Upstream tests
commanded closure and height only, so an empty second hand would pass.
"""

from rtphys.task import UP_F, UP_Y, Draw, Mesh, Robot, Task, above, held_by

APPROACH = 0.08  # [m] straight on to the handles
HELD, HIGH = 0.85, 0.8  # [m] height of the roller's frame: aimed at, and success


def layout(draw: Draw):
    model = draw.choice("model", 0, 2)
    spot = draw.spot("roller", x=(-0.15, 0.15), y=(-0.25, -0.05), yaw=(-0.8, 0.8))
    pose = spot.pose(UP_Y if model == 0 else UP_F)
    yield Mesh(name="roller", category="102_roller", model=model, pose=pose)


def script(robot: Robot) -> None:
    left, right = robot.left, robot.right
    robot.do(left.grasp("roller", (0,), pre=APPROACH), right.grasp("roller", (1,), pre=APPROACH))
    rise = HELD - robot.scene.pose("roller").p[2]
    robot.do(left.lift(rise), right.lift(rise))


task = Task(
    layout=layout,
    script=script,
    success=held_by("roller", "left", "right") & above("roller", HIGH),
    step_limit=400,
    arms="dual, in step",
    mechanism="dual lift",
    info={"A": "roller"},
)
