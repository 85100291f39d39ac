"""Stack two blocks that look alike, the heavy one below.

Success: the light block rests centred on the heavy one, and both hands are open.
"""

from rtphys.task import BLUE, Box, Draw, Robot, Scene, Task, at_rest, condition, hands_open

from .._blocks import HALF, Block, scattered, stack, stacked
from ._hidden import alike, ranked, weigh

USUAL = Box.density * (2 * HALF) ** 3  # [kg] of a block
BLOCKS = {name: Block(name, HALF, BLUE) for name in ("first", "second")}


def layout(draw: Draw):
    yield from alike(scattered(draw, list(BLOCKS.values()), clear=0.15))


def light_on_heavy(scene: Scene) -> bool:
    light, heavy = ranked(scene, "object_mass", list(BLOCKS))
    return stacked(light, heavy).holds(scene)


def script(robot: Robot) -> None:
    light, heavy = ranked(robot.scene, "object_mass", list(BLOCKS))
    stack(robot, [BLOCKS[heavy], BLOCKS[light]])


def feel(robot: Robot) -> dict[str, float]:
    return {f"object_mass@{name}": weigh(robot, name, USUAL) for name in BLOCKS}


task = Task(
    layout=layout,
    script=script,
    feel=feel,
    success=condition("the light block stands on the heavy one", light_on_heavy)
    & at_rest(*BLOCKS)
    & hands_open(),
    step_limit=1200,
    mechanism="hidden mass: stack",
)
