"""Filling a carrying basket with one hand and lifting it by its arch with the other."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from rtphys.task import (
    DOWN,
    LEFT,
    RIGHT,
    UP_Y,
    Aim,
    Arm,
    Condition,
    Draw,
    Infeasible,
    Mesh,
    Placing,
    Pose,
    Robot,
    Scene,
    axis_angle,
    condition,
    free_of,
    quat_multiply,
    touching,
    upright,
)

# [m] along and above the basket's frame, where a thing's origin is let go: as low as the hand
# comes; a long thing from above the rim, clear of the arch. The far half is out of reach.
SPOTS = (
    (-0.065, 0.02),
    (-0.065, 0.04),
    (-0.065, 0.06),
    (-0.075, 0.09),
    (-0.085, 0.09),
    (-0.075, 0.11),
    (-0.085, 0.11),
    (-0.075, 0.13),
)
_TURNS = (*(np.pi + extra for extra in (0.0, 0.3, -0.3)), 0.0, 0.3, -0.3)  # [rad]
_INTO = Placing(mode="free", pre=0.08, gap=0.0, along="point", yaws=(0.0, 0.5, -0.5, 1.0, -1.0))


def carrying_basket(draw: Draw, side: int) -> Mesh:
    """A basket in the middle, a little towards the hand that will lift it (the one off `side`)."""
    spot = draw.spot("basket", x=(-0.02 * side, -0.02 * side), y=(-0.08, -0.05))
    model = draw.choice("basket model", 0, 1)
    return Mesh(name="basket", category="110_basket", model=model, pose=spot.pose(UP_Y))


def fill_and_lift(
    robot: Robot, thing: str, contacts: Sequence[int] = (), depth: float = 0.0
) -> None:
    """The near hand drops the thing into the basket, the other lifts it.

    Raises:
        Infeasible: from the verbs.
    """
    arm = robot.nearest(thing)
    other = robot.other(arm)
    aim = Aim(_places(robot.scene, arm.side)[0], None, _INTO)

    def take() -> None:
        robot.do(arm.grasp(thing, contacts, pre=0.08, depth=depth, aim=aim))
        if not robot.tried(lambda: robot.do(arm.lift(0.15))):  # far out a hand can only come back
            robot.do(arm.retreat(0.08))

    robot.retake(take)
    _drop(robot, arm, thing)
    robot.do(arm.lift(0.05))
    robot.do(arm.home())
    robot.do(arm.wait(0.4))  # a can may still roll

    def take_basket() -> None:
        robot.do(other.grasp("basket", pre=0.08))
        robot.do(other.lift(0.06))

    robot.retake(take_basket)


def _places(scene: Scene, side: str) -> list[Pose]:
    """Where a thing's origin may be let go, the hand leaning in from its own side if it must."""
    basket = scene.pose("basket")
    inward = 1.0 if side == RIGHT else -1.0
    leans = [
        axis_angle(axis, lean)
        for axis, lean in (
            ((1, 0, 0), 0.0),
            ((0, inward, 0), 0.3),
            ((1, 0, 0), 0.3),
            ((1, inward, 0), 0.5),
        )
    ]
    spots = [(basket @ Pose((along, height, 0.0))).p for along, height in SPOTS]
    return [Pose(spot, quat_multiply(lean, DOWN)) for spot in spots for lean in leans]


def _drop(robot: Robot, arm: Arm, thing: str) -> None:
    """As low as the hand comes, with its rail along the arch and not across it."""
    closing, arch = arm.ee().R[:, 1], robot.scene.pose("basket").R[:, 2]
    # About DOWN, hence the order; a half turn makes no difference to the rail.
    turn = np.arctan2(closing[1], closing[0]) - np.arctan2(arch[1], arch[0])
    turn = float((turn + np.pi / 2) % np.pi - np.pi / 2)
    into = replace(_INTO, yaws=tuple(turn + extra for extra in _TURNS), clear=True)
    for place in _places(robot.scene, arm.side):
        if robot.tried(lambda place=place: robot.do(arm.place(thing, place, how=into))):
            return
    raise Infeasible("unreachable", f"the {arm.side} hand cannot bring it into the basket")


def filled_and_lifted(thing: str) -> Condition:
    """The thing lies in the basket, touching neither table nor hand, and a hand carries both."""
    return (
        condition(f"the {thing} is in the basket", lambda s: _inside(s, thing))
        & condition("a hand carries both", lambda s: _carried(s, thing))
        & upright("basket", axis=1, within=1.047)
        & touching(thing, "basket")
        & free_of(thing, "table", "left_gripper", "right_gripper")
    )


def _inside(scene: Scene, thing: str) -> bool:
    """The thing's origin between the basket's walls, in the basket's own frame."""
    x, y, z = (scene.pose("basket").inverse() @ scene.pose(thing)).p
    return abs(x) < 0.115 and abs(z) < 0.075 and -0.01 < y < 0.085


def _carried(scene: Scene, thing: str) -> bool:
    """Both at least 2 cm higher than at the start, the basket in a hand."""
    rises = [scene.pose(p).p[2] - scene.start(p).p[2] for p in ("basket", thing)]
    held = any(scene.touching(f"{side}_gripper", "basket") for side in (LEFT, RIGHT))
    return bool(min(rises) > 0.02) and held
