"""Filling a carrying basket with one hand and lifting it by its arch with the other."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from rtphys.task import (
    DOWN,
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
    in_hand,
    quat_multiply,
    touching,
    upright,
)

# [m] along and above the basket's frame, where an object's origin is released: as low as the hand
# comes; a long object from above the rim, clear of the arch. The far half is out of reach.
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
_LEAN, _BOTH_WAYS = 0.3, 0.5  # [rad] of the hand: inward or forward; both at once
_APPROACH = 0.08  # [m] before either grasp
_LIFT, _BACK = 0.15, 0.08  # [m] of the object over the rim; back, where it cannot be raised
_RETREAT, _RAISE = 0.05, 0.06  # [m] up from the released object; of the basket off the table
_ROLLING_TIME = 0.4  # [s] after which a can lies still in the basket
_HALF_LENGTH, _HALF_WIDTH = 0.115, 0.075  # [m] of the room between the basket's walls
_HEIGHT = (-0.01, 0.085)  # [m] of an object's origin in the basket
_TILT = 1.047  # [rad] of the carried basket, 60 deg
_RISE = 0.02  # [m] of basket and object since the start, at least, when they are carried


def carrying_basket(draw: Draw, side: int) -> Mesh:
    """A basket in the middle, a little towards the hand that will lift it (the one off `side`)."""
    spot = draw.spot("basket", x=(-0.02 * side, -0.02 * side), y=(-0.08, -0.05))
    model = draw.choice("basket model", 0, 1)
    return Mesh(name="basket", category="110_basket", model=model, pose=spot.pose(UP_Y))


def fill_and_lift(
    robot: Robot, prop: str, contacts: Sequence[int] = (), depth: float = 0.0
) -> None:
    """The near hand drops the object into the basket, the other lifts the basket.

    Raises:
        Infeasible: from the verbs.
    """
    arm = robot.nearest(prop)
    other = robot.other(arm)
    aim = Aim(_places(robot.scene, arm.side)[0], None, _INTO)

    def take() -> None:
        robot.do(arm.grasp(prop, contacts, _APPROACH, depth, aim=aim))
        if not robot.tried(lambda: robot.do(arm.lift(_LIFT))):  # far out a hand can only come back
            robot.do(arm.retreat(_BACK))

    robot.retake(take)
    _drop(robot, arm, prop)
    robot.do(arm.lift(_RETREAT))
    robot.do(arm.home())
    robot.do(arm.wait(_ROLLING_TIME))

    def take_basket() -> None:
        robot.do(other.grasp("basket", pre=_APPROACH))
        robot.do(other.lift(_RAISE))

    robot.retake(take_basket)


def _places(scene: Scene, side: str) -> list[Pose]:
    """Where an object's origin may be released, by an upright hand first, then by a leaning one."""
    basket = scene.pose("basket")
    inward = 1.0 if side == RIGHT else -1.0
    leans = [
        axis_angle(axis, lean)
        for axis, lean in (
            ((1, 0, 0), 0.0),
            ((0, inward, 0), _LEAN),
            ((1, 0, 0), _LEAN),
            ((1, inward, 0), _BOTH_WAYS),
        )
    ]
    spots = [(basket @ Pose((along, height, 0.0))).p for along, height in SPOTS]
    return [Pose(spot, quat_multiply(lean, DOWN)) for spot in spots for lean in leans]


def _drop(robot: Robot, arm: Arm, prop: str) -> None:
    """Release the object as low as the hand comes, its rail along the arch and not across it."""
    closing, arch = arm.ee().R[:, 1], robot.scene.pose("basket").R[:, 2]
    # About DOWN, hence the order; a half turn makes no difference to the rail.
    turn = np.arctan2(closing[1], closing[0]) - np.arctan2(arch[1], arch[0])
    turn = float((turn + np.pi / 2) % np.pi - np.pi / 2)
    into = replace(_INTO, yaws=tuple(turn + extra for extra in _TURNS), clear=True)
    places = _places(robot.scene, arm.side)
    place = robot.first_feasible(places, lambda at: robot.do(arm.place(prop, at, how=into)))
    if place is None:
        raise Infeasible("unreachable", f"the {arm.side} hand cannot bring it into the basket")


def filled_and_lifted(prop: str) -> Condition:
    """The object lies in the basket, touching neither table nor hand, and a hand carries both."""
    return (
        condition(f"the {prop} is in the basket", lambda s: _inside(s, prop))
        & condition("a hand carries both", lambda s: _carried(s, prop))
        & upright("basket", axis=1, within=_TILT)
        & touching(prop, "basket")
        & free_of(prop, "table", "left_gripper", "right_gripper")
    )


def _inside(scene: Scene, prop: str) -> bool:
    """The object's origin is between the basket's walls."""
    x, y, z = (scene.pose("basket").inverse() @ scene.pose(prop)).p
    return abs(x) < _HALF_LENGTH and abs(z) < _HALF_WIDTH and _HEIGHT[0] < y < _HEIGHT[1]


def _carried(scene: Scene, prop: str) -> bool:
    """Object and basket have risen, with the basket in a hand."""
    rises = [scene.pose(p).p[2] - scene.start(p).p[2] for p in ("basket", prop)]
    return bool(min(rises) > _RISE) and in_hand(scene, "basket")
