"""Empty the small desk bin into the big bin beside the table.

A bin on the right is first set down in the middle for the left hand. Success: the small bin is up
in a hand, and all five balls rest on the big bin's floor. Upstream does not ask that they rest.
"""

from collections.abc import Sequence
from functools import partial

import numpy as np

from rtphys.task import (
    DOWN,
    TABLE_TOP,
    UP_Z,
    Aim,
    Arm,
    Ball,
    Draw,
    Mesh,
    Motion,
    Placing,
    Pose,
    Robot,
    Scene,
    Task,
    at_rest,
    axis_angle,
    condition,
    in_hand,
    off_centre,
    place_at_first,
    quat_multiply,
)

from ._dustbin import DUSTBIN, in_dustbin, wait_for_rest

BALLS = tuple(f"ball{i}" for i in range(5))
RADIUS = 0.008  # [m]
YAW = 0.7973  # [rad] of the small bin, on average
ON_FLOOR = (0.13, 0.25)  # [m] heights of a ball in the big bin
MIDDLES = [
    Pose((x, y, TABLE_TOP), DOWN) for y in (-0.1, -0.05, -0.14) for x in (-0.02, -0.06, 0.02)
]
POUR = (-0.6947, -0.1782, 0.1660, -0.6769)  # of the hand: forward and 28 deg up (fact sheet)
# [m] of the mouth, over the big bin's middle
OVER = ((-0.47, 0.03, 1.17), (-0.45, 0.0, 1.14), (-0.42, -0.05, 1.12), (-0.47, 0.0, 1.22))
YAWS = (0.0, 0.4, -0.4)  # [rad] of the hand about the vertical
STEEPER = (0.5, 0.25, 0.0)  # [rad] beyond that: a bin that turned in the hand still pours
# [rad] about the hand's own axis, in turn: the first that can be reached
ROLLS = ((0.6, -0.6), (-0.6, 0.3), (1.0, 0.6), (-1.0, -0.6), (0.0,))
TRICKLE = 0.6  # [s] in which balls roll out
OUT = 0.4  # [m] a ball that is lower has left the small bin
PAUSE, STILL = 0.3, 0.02  # [s], [m/s] balls may bounce about in the big bin
APPROACH, LIFT = 0.08, 0.1  # [m] straight on to the bin; up, before it is poured
UP, RETREAT = 0.06, 0.1  # [m] where a bin on the right is moved: up; off it
STAND = Placing(mode="free", pre=0.06, gap=0.005, along="point")


def layout(draw: Draw):
    yield DUSTBIN
    turn = (YAW - 0.3696, YAW + 0.3696)
    spot = draw.spot("bin", x=(-0.2, 0.2), y=(-0.2, -0.05), yaw=turn, where=off_centre(0.05))
    model = draw.choice("model", 0, 3, 7, 8, 9, 10)
    yield Mesh(name="bin", category="063_tabletrashbin", model=model, pose=spot.pose(UP_Z))
    for i, name in enumerate(BALLS):
        x = spot.x + draw.uniform(f"{name} x", -0.01, 0.01)
        y = spot.y + draw.uniform(f"{name} y", -0.01, 0.01)
        place = Pose((x, y, 0.755 + 0.017 * i))
        yield Ball(
            name=name, radius=RADIUS, pose=place, resting=False, phrase="red ball", spin_decay=40.0
        )


def emptied(scene: Scene) -> bool:
    """All balls near the big bin's floor, between its walls."""
    return in_dustbin(scene, BALLS, ON_FLOOR)


def held_up(scene: Scene) -> bool:
    """The small bin at least 1 m above the ground, in a hand."""
    up = (scene.pose("dustbin").inverse() @ scene.pose("bin")).p[1] > 1.0
    return bool(up) and in_hand(scene, "bin", "left")


def tipped(scene: Scene, hand: Pose) -> list[Pose]:
    """ee poses from which the bin's mouth hangs over the big bin, best 57 deg below level."""
    forward = quat_multiply(POUR, axis_angle((1, 0, 0), np.pi))
    X_TB = scene.pose("bin")
    rim = (X_TB.inverse() @ scene.contact("bin")).p[1]
    mouth = (hand.inverse() @ X_TB @ Pose((0.0, rim, 0.0))).p  # as seen from the hand
    tips = (
        (place, Pose((0, 0, 0), quat_multiply(axis_angle((0, 0, 1), yaw), quat_multiply(down, q))))
        for down in (axis_angle((1, 0, 0), angle) for angle in STEEPER)
        for place in np.array(OVER)
        for yaw in YAWS
        for q in (forward, POUR)
    )
    return [Pose(place - turn.R @ mouth, turn.q) for place, turn in tips]


def rolled(arm: Arm, hand: Pose, angles: Sequence[float]) -> Motion:
    """Turn the hand about its own axis by the first of the angles [rad] that can be reached."""
    turns = (quat_multiply(hand.q, axis_angle((1, 0, 0), angle)) for angle in angles)
    return arm.reach(*(Pose(hand.p, turn) for turn in turns))


def script(robot: Robot) -> None:
    left, right, scene = robot.left, robot.right, robot.scene
    away: tuple[Motion, ...] = ()
    if scene.pose("bin").p[0] > 0:
        robot.do(right.grasp("bin", pre=APPROACH, aim=Aim(MIDDLES[0], None, STAND)))
        robot.do(right.lift(UP))
        robot.do(place_at_first(right, "bin", MIDDLES, STAND))
        robot.do(right.retreat(RETREAT))
        away = (right.home(),)
    robot.do(left.grasp("bin", pre=APPROACH), *away)
    robot.do(left.lift(LIFT))
    robot.do(left.reach(*tipped(scene, left.ee())))
    hand = left.ee()
    for angles in ROLLS:  # balls come to lie on the finger inside
        robot.tried(partial(robot.do, rolled(left, hand, angles)))
        robot.do(left.wait(TRICKLE))
        if all(scene.pose(ball).p[2] < OUT for ball in BALLS):
            break
    wait_for_rest(robot, BALLS, PAUSE, STILL)


task = Task(
    layout=layout,
    script=script,
    success=at_rest(*BALLS)
    & condition("the balls are in the big bin", emptied)
    & condition("the bin is held up", held_up),
    step_limit=600,
    mechanism="pour",
    table_shift=(0.3, 0.0),
    info={"A": "bin"},
)
