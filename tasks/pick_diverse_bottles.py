"""Lift two bottles of any kind at once, one in each hand, and bring them together in front.

Success: both stand side by side in the air, each in its own hand, near its place and off the
table. Upstream asks for position and height only.
"""

from rtphys.task import Draw, Task

from ._bottle_pairs import bottles_together, bring_bottles_together, two_bottles


def layout(draw: Draw):
    yield from two_bottles(draw, lambda side: draw.choice(f"{side} model", *range(20)))


task = Task(
    layout=layout,
    script=bring_bottles_together,
    success=bottles_together(),
    step_limit=400,
    arms="dual, in step",
    mechanism="pick two",
    info={"A": "left_bottle", "B": "right_bottle"},
)
