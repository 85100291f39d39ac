"""Stack the green block on the red one and the blue one on top.

Success: green rests centred on red, blue on green, and both hands are open.
"""

from rtphys.task import (
    BLUE,
    DOWN,
    GREEN,
    RED,
    Aim,
    Draw,
    Placing,
    Pose,
    Robot,
    Task,
    at_rest,
    hands_open,
    near,
)

from ._blocks import Block, scattered

HALF = 0.025  # [m]
BLOCKS = [Block(name, HALF, c) for name, c in (("red", RED), ("green", GREEN), ("blue", BLUE))]
ONTO = Placing(pre=0.05, gap=0.0, along="point")
CENTRED = {"within": (0.025, 0.025, 0.012), "offset": (0, 0, 2 * HALF)}


def layout(draw: Draw):
    yield from scattered(draw, BLOCKS, clear=0.15)


def script(robot: Robot) -> None:
    target = Pose((0.0, -0.13, 0.74), DOWN)
    last = None
    for block in BLOCKS:
        arm = robot.nearest(block.name)
        away = [last.home()] if last and last is not arm else []
        robot.do(arm.grasp(block.name, pre=0.09, aim=Aim(target, 0, ONTO)), *away)
        robot.do(arm.lift(0.07))
        robot.do(arm.place(block.name, target, point=0, how=ONTO))
        robot.do(arm.lift(0.07))
        target, last = robot.scene.functional(block.name, 1), arm


task = Task(
    layout=layout,
    script=script,
    success=near("green", "red", **CENTRED)
    & near("blue", "green", **CENTRED)
    & at_rest("blue")
    & hands_open(),
    step_limit=1200,
    mechanism="stack",
    info={"A": "red", "B": "green", "C": "blue", "a": "arm:red", "b": "arm:green", "c": "arm:blue"},
)
