"""Lift one of two blocks that look alike and differ in what no picture shows."""

from rtphys.task import BLUE, Box, Draw, Pose, Robot, Task, lifted

HALF = (0.02, 0.03, 0.012)  # [m]


def layout(draw: Draw):
    for name, side in (("left_block", -1), ("right_block", 1)):
        x = side * draw.uniform(name, 0.12, 0.2)
        yield Box(name=name, pose=Pose((x, -0.1, 0)), half_size=HALF, colour=BLUE)


def script(robot: Robot) -> None:
    arm = robot.nearest("left_block")
    robot.do(arm.grasp("left_block"))
    robot.do(arm.lift(0.1))


task = Task(layout=layout, script=script, success=lifted("left_block", 0.05), step_limit=400)
