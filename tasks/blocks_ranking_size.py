"""Line up a large, a medium and a small block from left to right.

Success: neighbours in that order within 13 cm sideways and 3 cm in depth, and both hands are open.
Added to upstream's test: all three stand on the table, at rest.
"""

from rtphys.task import (
    Draw,
    Infeasible,
    Robot,
    Task,
)

from ._blocks import Block, line_up, lined_up, ranked, scattered

HALVES = {"large": (0.030, 0.033), "medium": (0.024, 0.027), "small": (0.018, 0.021)}  # [m]
ROW = {"large": -0.115, "medium": 0.0, "small": 0.105}  # [m] x; open fingers fit between neighbours


def layout(draw: Draw):
    blocks = [Block(n, draw.uniform(f"half {n}", *HALVES[n]), colour(draw, n)) for n in ROW]
    boxes = scattered(draw, blocks, clear=0.1)
    if ranked(boxes):
        raise Infeasible("layout", "the blocks are in order already")
    yield from boxes


def colour(draw: Draw, name: str) -> tuple[float, float, float]:
    """Any colour: only size tells the blocks apart."""
    r, g, b = (draw.uniform(f"{channel} of {name}", 0, 1) for channel in "rgb")
    return r, g, b


def script(robot: Robot) -> None:
    line_up(robot, ROW)


task = Task(
    layout=layout,
    script=script,
    success=lined_up(*ROW),
    step_limit=1200,
    mechanism="order",
    info={
        **{"A": "large", "B": "medium", "C": "small"},
        **{"a": "arm:large", "b": "arm:medium", "c": "arm:small"},
    },
)
