"""Toy blocks that are scattered in front of the robot, to be stacked or to be set in a row."""

import itertools
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from rtphys.task import (
    BLUE,
    DOWN,
    GREEN,
    RED,
    TABLE_TOP,
    Aim,
    Arm,
    Box,
    Condition,
    Draw,
    Placing,
    Pose,
    Robot,
    at_rest,
    clear_of,
    hands_open,
    in_row,
    near,
    off_centre,
    on_table,
    reachable,
)

MIDDLE = (0.0, -0.1)  # [m] where such tasks build, kept free at the start
APART = 0.1  # [m] between the centres of two blocks
APPROACH, LIFT = 0.09, 0.07  # [m] before the grasp; to carry a block, and up from it
SET_DOWN = Placing(pre=0.05, gap=0.0, along="point")
STACK = Pose((0.0, -0.13, TABLE_TOP), DOWN)  # where the lowest block of a stack stands
ROW_Y = -0.19  # [m] of a row of blocks
ROW_GAP, ROW_DEPTH = 0.13, 0.04  # [m] between neighbours that nearly form a row, in x and y
CENTRED = (0.025, 0.025, 0.012)  # [m] of a block from where the one below carries it
HALF = 0.025  # [m] half an edge of a block that is stacked


@dataclass(frozen=True)
class Block:
    """One cube to be scattered."""

    name: str
    half: float  # [m]
    colour: tuple[float, float, float]


RED_BLOCK, GREEN_BLOCK = Block("red", HALF, RED), Block("green", HALF, GREEN)
BLUE_BLOCK = Block("blue", HALF, BLUE)


def scattered(draw: Draw, blocks: Sequence[Block], clear: float) -> list[Box]:
    """Cubes anywhere in front, each clearly on one side, none in anybody's way.

    Spawn ranges: RoboTwin fact sheet, 2.3, 2.4, 2.45, 2.46.

    Args:
        clear: least distance [m] from MIDDLE.

    Raises:
        Infeasible: "layout".
    """
    taken = [(MIDDLE, clear)]
    boxes = []
    for block in blocks:
        free = clear_of(*taken)
        spot = draw.spot(
            block.name,
            x=(-0.28, 0.28),
            y=(-0.08, 0.05),
            yaw=(-0.75, 0.75),
            where=lambda s, free=free: off_centre(0.05)(s) and reachable(s) and free(s),
        )
        taken.append(((spot.x, spot.y), APART))
        h, phrase = block.half, f"{block.name} block"
        boxes.append(
            Box(
                name=block.name,
                half_size=(h, h, h),
                colour=block.colour,
                pose=spot.pose(),
                phrase=phrase,
            )
        )
    return boxes


def ranked(boxes: Sequence[Box]) -> bool:
    """Whether the boxes nearly form a row from left to right: little would be left to do."""
    gaps = [b.pose.p - a.pose.p for a, b in itertools.pairwise(boxes)]
    return all(0 < gap[0] < ROW_GAP and abs(gap[1]) < ROW_DEPTH for gap in gaps)


def put_block(robot: Robot, name: str, place: Pose, last: Arm | None) -> Arm:
    """Set a block's foot down at a place, while the arm that was last goes home unless it is used.

    Returns:
        The arm that was used.

    Raises:
        Infeasible: from the verbs.
    """
    arm = robot.nearest(name)
    away = [last.home()] if last and last is not arm else []
    robot.do(arm.grasp(name, pre=APPROACH, aim=Aim(place, 0, SET_DOWN)), *away)
    robot.do(arm.lift(LIFT))
    robot.do(arm.place(name, place, point=0, how=SET_DOWN))
    robot.do(arm.lift(LIFT))
    return arm


def line_up(robot: Robot, row: Mapping[str, float]) -> None:
    """The blocks side by side, each at its x [m].

    Raises:
        Infeasible: from the verbs.
    """
    arm = None
    for name, x in row.items():
        arm = put_block(robot, name, Pose((x, ROW_Y, TABLE_TOP), DOWN), arm)


def lined_up(*names: str) -> Condition:
    """Blocks in a row from left to right on the table, at rest, both hands open."""
    done = in_row(*names) & on_table(*names)
    for name in names:
        done = done & at_rest(name)
    return done & hands_open()


def stack(robot: Robot, blocks: Sequence[Block]) -> None:
    """The first block in the middle of the table, each further one on the last.

    Raises:
        Infeasible: from the verbs.
    """
    place, arm = STACK, None
    for block in blocks:
        arm = put_block(robot, block.name, place, arm)
        place = robot.scene.functional(block.name, 1)


def stacked(block: str, below: str) -> Condition:
    """A block of the stack is centred on the one below."""
    return near(block, below, within=CENTRED, offset=(0, 0, 2 * HALF))
