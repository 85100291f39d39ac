"""Nest three bowls in the middle of the table.

Success: each further bowl rests centred in the one below, a nest's height above it, the first on
the table, and both hands are open. Upstream bounds heights from above only and asks for no rest.
"""

from rtphys.task import Draw, Robot, Task

from ._bowls import bowls_nested, nest_bowls, scattered_bowls

BOWLS = ("bowl1", "bowl2", "bowl3")


def layout(draw: Draw):
    yield from scattered_bowls(draw, BOWLS)


def script(robot: Robot) -> None:
    nest_bowls(robot, BOWLS)


task = Task(
    layout=layout,
    script=script,
    success=bowls_nested(BOWLS),
    step_limit=1200,
    mechanism="nest",
    info={"A": "bowl1"},
)
