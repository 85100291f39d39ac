"""Put one thing directly to the right of another.

Success: they are 8 to 20 cm apart, in this order, less than 5 cm apart in depth, and both hands are
open. Added to upstream's test: both lie on the table, at rest, and a hand lifted the first.
"""

from rtphys.task import RIGHT, Draw, Robot, Spot, Task

from ._everyday import pair
from ._set_beside import set_beside, stands_beside


def layout(draw: Draw):
    yield from pair(draw, room)


def room(first: Spot) -> tuple[float, float]:
    """The hand that takes the first must reach the right of the other."""
    return (-0.1, 0.1) if first.side == "right" else (-0.23, -0.18)


def script(robot: Robot) -> None:
    set_beside(robot, RIGHT)


task = Task(
    layout=layout,
    script=script,
    success=stands_beside(RIGHT),
    step_limit=400,
    keep_clear=(((-0.2, 0.34), (-0.28, 0.08)),),  # where it may have to go
    mechanism="place: relative",
    info={"A": "thing", "B": "other", "a": "arm:thing"},
)
