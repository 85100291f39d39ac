"""Put one thing directly to the left of another.

Success: they are 8 to 20 cm apart, in this order, less than 5 cm apart in depth, and both hands are
open. Added to upstream's test: both lie on the table, at rest, and a hand lifted the first.
"""

from rtphys.task import LEFT, Draw, Robot, Spot, Task

from ._everyday import pair
from ._set_beside import set_beside, stands_beside


def layout(draw: Draw):
    yield from pair(draw, room)


def room(first: Spot) -> tuple[float, float]:
    """The hand that takes the first must reach the left of the other."""
    return (0.18, 0.23) if first.side == "right" else (-0.1, 0.1)


def script(robot: Robot) -> None:
    set_beside(robot, LEFT)


task = Task(
    layout=layout,
    script=script,
    success=stands_beside(LEFT),
    step_limit=400,
    keep_clear=(((-0.34, 0.2), (-0.28, 0.08)),),  # where it may have to go
    mechanism="place: relative",
    info={"A": "thing", "B": "other", "a": "arm:thing"},
)
