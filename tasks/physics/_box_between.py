"""One of two props that look alike goes into a box between them."""

from collections.abc import Iterator

import numpy as np

from rtphys.task import (
    BLUE,
    DOWN,
    UP_Y,
    Box,
    Draw,
    Mesh,
    Placing,
    Pose,
    Prop,
    Robot,
    Scene,
    at_rest,
    hands_open,
    on_table,
)

from ._hidden import APPROACH

PAIR = ("first", "second")
LIFT, RETREAT = 0.12, 0.08  # [m] over the box's wall; up from what was put in
INSIDE = 0.06  # [m] of a prop from the box's middle, per axis
RESTS = at_rest(*PAIR) & hands_open()  # what success asks for, too


def box_between(draw: Draw, half: tuple[float, float, float], mass: float) -> Iterator[Prop]:
    """The box, and on either side of it one of the pair [m, kg]."""
    box = draw.spot("box", x=(0.0, 0.0), y=(-0.12, -0.08))
    yield Mesh(name="box", category="062_plasticbox", model=3, pose=box.pose(UP_Y), fixed=True)
    sides = draw.shuffled("side", [(-0.27, -0.17), (0.17, 0.27)])
    for name, x in zip(PAIR, sides, strict=True):
        spot = draw.spot(name, x=x, y=(-0.17, -0.07), yaw=(-0.5, 0.5))
        yield Box(name=name, half_size=half, colour=BLUE, pose=spot.pose(), mass_kg=mass)


def only_in_box(scene: Scene, wanted: str, other: str) -> bool:
    """Whether the wanted one is in the box, and the other one on the table."""
    off = np.abs(scene.pose(wanted).p - scene.pose("box").p)[:2]
    inside = bool(np.all(off < INSIDE)) and not scene.touching(wanted, "table")
    return inside and on_table(other).holds(scene)


def put_in_box(robot: Robot, prop: str, gap: float) -> None:
    """Let go of a prop `gap` [m] above the box's floor."""
    arm, floor = robot.nearest(prop), Pose(robot.scene.pose("box").p, DOWN)
    into = Placing(mode="free", pre=0.06, gap=gap, along="point")
    robot.do(arm.grasp(prop, pre=APPROACH))
    robot.do(arm.lift(LIFT))
    robot.do(arm.place(prop, floor, point=0, how=into))
    robot.do(arm.lift(RETREAT))
