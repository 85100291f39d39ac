"""Line up three blocks that look alike by weight, the lightest on the left.

Success: neighbours in that order within 13 cm sideways and 3 cm in depth, on the table, at rest,
and both hands are open.
"""

from rtphys.task import BLUE, Box, Draw, Robot, Scene, Task, condition

from .._blocks import Block, line_up, lined_up, scattered
from ._hidden import alike, ranked, weigh

NAMES = ("first", "second", "third")
HALF = 0.02  # [m] half an edge
USUAL = Box.density * (2 * HALF) ** 3  # [kg] of a block
PLACES = (-0.105, 0.0, 0.105)  # [m] x; open fingers fit between neighbours


def layout(draw: Draw):
    yield from alike(scattered(draw, [Block(name, HALF, BLUE) for name in NAMES], clear=0.15))


def sorted_by_weight(scene: Scene) -> bool:
    return lined_up(*ranked(scene, "object_mass", NAMES)).holds(scene)


def script(robot: Robot) -> None:
    line_up(robot, dict(zip(ranked(robot.scene, "object_mass", NAMES), PLACES, strict=True)))


def feel(robot: Robot) -> dict[str, float]:
    return {f"object_mass@{name}": weigh(robot, name, USUAL) for name in NAMES}


task = Task(
    layout=layout,
    script=script,
    feel=feel,
    success=condition("the blocks are in a row, the lightest on the left", sorted_by_weight),
    step_limit=2000,
    mechanism="hidden mass: order",
)
