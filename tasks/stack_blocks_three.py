"""Stack the green block on the red one and the blue one on top.

Success: green rests centred on red, blue on green, and both hands are open.
"""

from rtphys.task import Draw, Robot, Task, at_rest, hands_open

from ._blocks import BLUE_BLOCK, GREEN_BLOCK, RED_BLOCK, scattered, stack, stacked

BLOCKS = (RED_BLOCK, GREEN_BLOCK, BLUE_BLOCK)  # from below


def layout(draw: Draw):
    yield from scattered(draw, BLOCKS, clear=0.15)


def script(robot: Robot) -> None:
    stack(robot, BLOCKS)


task = Task(
    layout=layout,
    script=script,
    success=stacked("green", "red") & stacked("blue", "green") & at_rest("blue") & hands_open(),
    step_limit=1200,
    mechanism="stack",
    info={"A": "red", "B": "green", "C": "blue", "a": "arm:red", "b": "arm:green", "c": "arm:blue"},
)
