"""Tap the plunger of a desk bell.

Success: a fingertip of a closed hand that points down has touched the bell from above at its
plunger. Upstream does not ask where the hand points; then a hand that trembles about the table
rings the bell with its side in 3 of 25 episodes.
"""

from rtphys.task import UP_Y, Draw, Mesh, Robot, Task, off_centre, pressed

ABOVE, REACH = 0.1, 0.07  # [m] TCP over the plunger; way of the tap, at most
RETREAT = 0.045  # [m] off the plunger


def layout(draw: Draw):
    spot = draw.spot("bell", x=(-0.25, 0.25), y=(-0.2, 0.0), where=off_centre(0.05))
    model = draw.choice("model", 0, 1)
    yield Mesh(name="bell", category="050_bell", model=model, pose=spot.pose(UP_Y), fixed=True)


def script(robot: Robot) -> None:
    arm = robot.nearest("bell")
    robot.do(arm.hover("bell", contact=0, gap=ABOVE), arm.close())
    robot.do(arm.press("bell", reach=REACH))
    robot.do(arm.retreat(RETREAT))


task = Task(
    layout=layout,
    script=script,
    success=pressed("bell", contact=0, within=(0.025, 0.025, 0.03)),
    step_limit=400,
    mechanism="press",
    info={"A": "bell", "a": "arm:bell"},
)
