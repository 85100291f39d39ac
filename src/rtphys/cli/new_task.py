"""`rtphys new-task`: a task file to start from."""

import re
from pathlib import Path
from typing import Annotated

import typer

from rtphys.cli.terminal import say
from rtphys.core import library
from rtphys.core.errors import BadFile, BadValue

TEMPLATE = '''"""Put the block on the pad.

Success: the block rests on the pad, and both hands are open.
"""

from rtphys.task import (
    BLUE,
    Aim,
    Box,
    Draw,
    Placing,
    Robot,
    Task,
    at_rest,
    clear_of,
    hands_open,
    points_meet,
)

ONTO = Placing(pre=0.06, gap=0.0, along="point")


def layout(draw: Draw):
    """What stands where; depends on the seed alone."""
    pad = draw.spot("pad", x=(0.05, 0.25), y=(-0.2, 0.0))
    yield Box(
        name="pad", half_size=(0.04, 0.04, 0.0005), colour=BLUE, pose=pad.pose(), fixed=True,
        phrase="blue pad",
    )  # fmt: skip
    free = clear_of((pad, 0.12))
    spot = draw.spot("block", x=(0.05, 0.28), y=(-0.15, 0.05), yaw=(-0.7, 0.7), where=free)
    yield Box(name="block", half_size=(0.025,) * 3, pose=spot.pose(), phrase="red block")


def script(robot: Robot) -> None:
    """The expert: verbs of `robot.left` and `robot.right`, carried out by `robot.do`."""
    arm, target = robot.nearest("block"), robot.scene.functional("pad", 1)
    robot.do(arm.grasp("block", aim=Aim(target, 0, ONTO)))
    robot.do(arm.lift(0.07))
    robot.do(arm.place("block", target, point=0, how=ONTO))
    robot.do(arm.retreat(0.07))


task = Task(
    layout=layout,
    script=script,
    success=points_meet("block", 0, "pad", 1, within=(0.03, 0.03, 0.01))
    & at_rest("block")
    & hands_open(),
    step_limit=400,
    mechanism="pick, place",
    info={"A": "block", "B": "pad", "a": "arm:block"},
)
'''


def new_task(
    name: Annotated[str, typer.Argument(help="verb_object, such as place_spoon.")],
    folder: Annotated[
        Path, typer.Option("--in", help="The library that gets tasks/NAME.py.")
    ] = Path(),
) -> None:
    """Write a task file to start from; it runs as it is.

    Its place, a library, is a folder of yours; the second command tries the task there.

    Examples:

        rtphys new-task place_spoon --in my_lab
        rtphys --library my_lab check place_spoon
    """
    if not re.fullmatch(r"[a-z][a-z0-9]*(_[a-z0-9]+)*", name):
        raise BadValue("name", name, "a name is words of a-z and 0-9 joined by _")
    path = folder / "tasks" / f"{name}.py"
    if name in library.names("tasks") or path.exists():
        raise BadValue("name", name, "there is a task of that name already", path)
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(TEMPLATE)
    except OSError as error:
        raise BadFile(path, error.strerror or "cannot be written") from error
    say(f"{path}\ntry it: rtphys --library {folder} check {name} --seeds 20")
