"""Line up a red, a green and a blue block from left to right.

Success: neighbours in that order within 13 cm sideways and 3 cm in depth, and both hands are open.
Added to upstream's test: all three stand on the table, at rest.
"""

from rtphys.task import (
    BLUE,
    DOWN,
    GREEN,
    RED,
    Aim,
    Draw,
    Infeasible,
    Placing,
    Pose,
    Robot,
    Task,
    at_rest,
    hands_open,
    in_row,
    on_table,
)

from ._blocks import Block, ranked, scattered

COLOURS = {"red": RED, "green": GREEN, "blue": BLUE}
ROW = {"red": -0.105, "green": 0.0, "blue": 0.105}  # [m] x; open fingers fit between neighbours
DEPTH = -0.19  # [m] y of the row
LINE_UP = Placing(pre=0.05, gap=0.0, along="point")


def layout(draw: Draw):
    half = draw.uniform("half", 0.015, 0.025)
    boxes = scattered(draw, [Block(name, half, COLOURS[name]) for name in ROW], clear=0.1)
    if ranked(boxes):
        raise Infeasible("layout", "the blocks are in order already")
    yield from boxes


def script(robot: Robot) -> None:
    last = None
    for name, x in ROW.items():
        arm, place = robot.nearest(name), Pose((x, DEPTH, 0.74), DOWN)
        away = [last.home()] if last and last is not arm else []
        robot.do(arm.grasp(name, pre=0.09, aim=Aim(place, 0, LINE_UP)), *away)
        robot.do(arm.lift(0.07))
        robot.do(arm.place(name, place, point=0, how=LINE_UP))
        robot.do(arm.lift(0.07))
        last = arm


task = Task(
    layout=layout,
    script=script,
    success=in_row(*ROW)
    & on_table(*ROW)
    & at_rest("red")
    & at_rest("green")
    & at_rest("blue")
    & hands_open(),
    step_limit=1200,
    mechanism="order",
    info={
        **{"A": "red", "B": "green", "C": "blue"},
        **{"a": "arm:red", "b": "arm:green", "c": "arm:blue"},
    },
)
