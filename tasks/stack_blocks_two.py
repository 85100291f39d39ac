"""Stack the green block on the red one in the middle of the table.

Success: green rests centred on red, and both hands are open.
"""

from rtphys.task import (
    BLUE,
    DOWN,
    GREEN,
    RED,
    Aim,
    Box,
    Draw,
    Placing,
    Pose,
    Robot,
    Task,
    at_rest,
    clear_of,
    hands_open,
    near,
    off_centre,
    reachable,
)

HALF = 0.025  # [m]
COLOURS = {"red": RED, "green": GREEN, "blue": BLUE}
ONTO = Placing(pre=0.05, gap=0.0, along="point")


def layout(draw: Draw):
    taken = [((0.0, -0.1), 0.15)]
    for name in ("red", "green"):
        free = clear_of(*taken)
        spot = draw.spot(
            name,
            x=(-0.28, 0.28),
            y=(-0.08, 0.05),
            yaw=(-0.75, 0.75),
            where=lambda s, free=free: off_centre(0.05)(s) and reachable(s) and free(s),
        )
        taken.append((spot, 0.1))
        colour = COLOURS[name]
        phrase = f"{name} block"
        yield Box(name=name, half_size=(HALF,) * 3, colour=colour, pose=spot.pose(), phrase=phrase)


def script(robot: Robot) -> None:
    target = Pose((0.0, -0.13, 0.74), DOWN)
    last = None
    for name in ("red", "green"):
        arm = robot.nearest(name)
        away = [last.home()] if last and last is not arm else []
        robot.do(arm.grasp(name, pre=0.09, aim=Aim(target, 0, ONTO)), *away)
        robot.do(arm.lift(0.07))
        robot.do(arm.place(name, target, point=0, how=ONTO))
        robot.do(arm.lift(0.07))
        target, last = robot.scene.functional(name, 1), arm


task = Task(
    layout=layout,
    script=script,
    success=near("green", "red", within=(0.025, 0.025, 0.012), offset=(0, 0, 2 * HALF))
    & at_rest("green")
    & hands_open(),
    step_limit=800,
    mechanism="stack",
    info={"A": "red", "B": "green", "a": "arm:red", "b": "arm:green"},
)
