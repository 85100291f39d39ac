"""Stack the green block on the red one in the middle of the table.

Success: green rests centred on red, and both hands are open.
"""

from rtphys.task import Draw, Robot, Task, at_rest, hands_open

from ._blocks import GREEN_BLOCK, RED_BLOCK, scattered, stack, stacked

BLOCKS = (RED_BLOCK, GREEN_BLOCK)  # from below


def layout(draw: Draw):
    yield from scattered(draw, BLOCKS, clear=0.15)


def script(robot: Robot) -> None:
    stack(robot, BLOCKS)


task = Task(
    layout=layout,
    script=script,
    success=stacked("green", "red") & at_rest("green") & hands_open(),
    step_limit=800,
    mechanism="stack",
    info={"A": "red", "B": "green", "a": "arm:red", "b": "arm:green"},
)
