"""Press the stapler down at its free end.

Success: a fingertip of a closed hand has touched the stapler at its press point. Upstream does not
ask for a closed hand.
"""

from math import pi

from rtphys.task import UP_Y, Draw, Mesh, Robot, Task, pressed


def layout(draw: Draw):
    spot = draw.spot("stapler", x=(-0.2, 0.2), y=(-0.1, 0.05), yaw=(-pi, pi))
    model, pose = draw.choice("model", *range(7)), spot.pose(UP_Y)
    yield Mesh(name="stapler", category="048_stapler", model=model, pose=pose, fixed=True)


def script(robot: Robot) -> None:
    arm = robot.nearest("stapler")
    robot.do(arm.hover("stapler", contact=2, gap=0.1), arm.close())
    robot.do(arm.press("stapler", reach=0.08))
    robot.do(arm.retreat(0.06))


task = Task(
    layout=layout,
    script=script,
    success=pressed("stapler", contact=2, within=(0.03, 0.03, 0.03), closed_below=0.2),
    step_limit=400,
    mechanism="press",
    info={"A": "stapler", "a": "arm:stapler"},
)
