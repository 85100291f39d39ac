"""Line up a red, a green and a blue block from left to right.

Success: neighbours in that order within 13 cm sideways and 3 cm in depth, and both hands are open.
Added to upstream's test: all three stand on the table, at rest.
"""

from rtphys.task import (
    BLUE,
    GREEN,
    RED,
    Draw,
    Infeasible,
    Robot,
    Task,
)

from ._blocks import Block, line_up, lined_up, ranked, scattered

COLOURS = {"red": RED, "green": GREEN, "blue": BLUE}
ROW = {"red": -0.105, "green": 0.0, "blue": 0.105}  # [m] x; open fingers fit between neighbours


def layout(draw: Draw):
    half = draw.uniform("half", 0.015, 0.025)
    boxes = scattered(draw, [Block(name, half, COLOURS[name]) for name in ROW], clear=0.1)
    if ranked(boxes):
        raise Infeasible("layout", "the blocks are in order already")
    yield from boxes


def script(robot: Robot) -> None:
    line_up(robot, ROW)


task = Task(
    layout=layout,
    script=script,
    success=lined_up(*ROW),
    step_limit=1200,
    mechanism="order",
    info={
        **{"A": "red", "B": "green", "C": "blue"},
        **{"a": "arm:red", "b": "arm:green", "c": "arm:blue"},
    },
)
