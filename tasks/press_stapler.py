"""Press the stapler down at its free end.

Success: a fingertip of a closed hand that points down has touched the stapler from above at its
press point. Upstream asks neither for a closed hand nor where it points.
"""

from math import pi

from rtphys.task import UP_Y, Draw, Infeasible, Mesh, Robot, Task, pressed

PRESS_POINT = 2  # contact point at the free end
GAPS = (0.1, 0.05, 0.02)  # [m] over the free end; a far hand is in reach only from close by
REACH, RETREAT = 0.08, 0.06  # [m] down from the hover, at most; back up


def layout(draw: Draw):
    spot = draw.spot("stapler", x=(-0.2, 0.2), y=(-0.1, 0.05), yaw=(-pi, pi))
    model, pose = draw.choice("model", *range(7)), spot.pose(UP_Y)
    yield Mesh(name="stapler", category="048_stapler", model=model, pose=pose, fixed=True)


def script(robot: Robot) -> None:
    arm = robot.nearest("stapler")

    def above(gap: float) -> None:
        robot.do(arm.hover("stapler", contact=PRESS_POINT, gap=gap), arm.close())

    if robot.first_feasible(GAPS, above) is None:
        raise Infeasible("unreachable", f"no posture of the {arm.side} arm over the stapler")
    robot.do(arm.press("stapler", reach=REACH))
    robot.do(arm.retreat(RETREAT))


task = Task(
    layout=layout,
    script=script,
    success=pressed("stapler", contact=PRESS_POINT, within=(0.02, 0.02, 0.03)),
    step_limit=400,
    mechanism="press",
    info={"A": "stapler", "a": "arm:stapler"},
)
