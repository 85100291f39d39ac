"""Tap the button on top of an alarm clock.

Success: a fingertip of a closed hand that points down has touched the clock from above at its
button. Upstream does not ask where the hand points; then an arm that drifts at random brushes the
button from the side in 4 of 100 episodes.
"""

from math import pi

from rtphys.task import UP_Y, Draw, Mesh, Robot, Task, off_centre, pressed

ABOVE, REACH = 0.06, 0.05  # [m] TCP over the button; way of the tap, at most
RETREAT = 0.02  # [m] off the button


def layout(draw: Draw):
    spot = draw.spot("clock", x=(-0.25, 0.25), y=(-0.2, 0.0), yaw=(-pi, pi), where=off_centre(0.05))
    model, pose = draw.choice("model", 1, 3), spot.pose(UP_Y)
    yield Mesh(name="clock", category="046_alarm-clock", model=model, pose=pose, fixed=True)


def script(robot: Robot) -> None:
    arm = robot.nearest("clock")
    robot.do(arm.hover("clock", contact=0, gap=ABOVE), arm.close())
    robot.do(arm.press("clock", reach=REACH))
    robot.do(arm.retreat(RETREAT))


task = Task(
    layout=layout,
    script=script,
    success=pressed("clock", contact=0, within=(0.02, 0.02, 0.03)),
    step_limit=400,
    mechanism="press",
    info={"A": "clock", "a": "arm:clock"},
)
