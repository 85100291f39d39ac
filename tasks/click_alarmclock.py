"""Tap the button on top of an alarm clock.

Success: a fingertip of the closed hand on the clock's side has touched the clock at its button.
"""

from math import pi

from rtphys.task import UP_Y, Draw, Mesh, Robot, Task, off_centre, pressed


def layout(draw: Draw):
    spot = draw.spot("clock", x=(-0.25, 0.25), y=(-0.2, 0.0), yaw=(-pi, pi), where=off_centre(0.05))
    model, pose = draw.choice("model", 1, 3), spot.pose(UP_Y)
    yield Mesh(name="clock", category="046_alarm-clock", model=model, pose=pose, fixed=True)


def script(robot: Robot) -> None:
    arm = robot.nearest("clock")
    robot.do(arm.hover("clock", contact=0, gap=0.06), arm.close())
    robot.do(arm.press("clock", reach=0.065))
    robot.do(arm.retreat(0.02))


task = Task(
    layout=layout,
    script=script,
    success=pressed("clock", contact=0, within=(0.03, 0.03, 0.03), closed_below=0.2),
    step_limit=400,
    mechanism="press",
    info={"A": "clock", "a": "arm:clock"},
)
