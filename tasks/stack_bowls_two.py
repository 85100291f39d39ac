"""Nest one bowl in another in the middle of the table.

Success: the second bowl rests centred in the first, a nest's height above it, the first on the
table, and both hands are open. Upstream bounds heights from above only and does not ask for rest.
"""

from rtphys.task import Draw, Robot, Task

from ._bowls import bowls_nested, nest_bowls, scattered_bowls

BOWLS = ("bowl1", "bowl2")


def layout(draw: Draw):
    yield from scattered_bowls(draw, BOWLS)


def script(robot: Robot) -> None:
    nest_bowls(robot, BOWLS)


task = Task(
    layout=layout,
    script=script,
    success=bowls_nested(BOWLS),
    step_limit=900,
    mechanism="nest",
    info={"A": "bowl1", "B": "bowl2", "a": "arm:bowl1", "b": "arm:bowl2"},
)
