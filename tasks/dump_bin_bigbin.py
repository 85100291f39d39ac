"""Empty the small desk bin into the big bin beside the table.

A bin on the right is first set down in the middle for the left hand. Success: the small bin is up
in a hand, and all five balls rest on the big bin's floor. Upstream does not ask that they rest.
"""

import numpy as np

from rtphys.task import (
    DOWN,
    UP_Y,
    UP_Z,
    Aim,
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
    off_centre,
    place_at_first,
    quat_multiply,
)

BALLS = tuple(f"ball{i}" for i in range(5))
RADIUS = 0.008  # [m]
BIN = Pose((-0.45, 0.0, 0.0), UP_Y)  # on the ground, whatever the table does
YAW = 0.7973  # [rad]
MIDDLES = [Pose((x, y, 0.74), DOWN) for y in (-0.1, -0.05, -0.14) for x in (-0.02, -0.06, 0.02)]
POUR = (-0.6947, -0.1782, 0.1660, -0.6769)  # of the hand: forward and 28 deg up (fact sheet)
# [m] of the mouth, over the big bin's middle
OVER = ((-0.47, 0.03, 1.17), (-0.45, 0.0, 1.14), (-0.42, -0.05, 1.12), (-0.47, 0.0, 1.22))
STEEPER = (0.5, 0.25, 0.0)  # [rad] beyond that: a bin that turned in the hand still pours
# [rad] about the hand's own axis, in turn: the first that can be reached
ROLLS = ((0.6, -0.6), (-0.6, 0.3), (1.0, 0.6), (-1.0, -0.6), (0.0,))
STAND = Placing(mode="free", pre=0.06, gap=0.005, along="point")


def layout(draw: Draw):
    yield Mesh(
        name="dustbin", category="011_dustbin", model=0, pose=BIN, fixed=True, on_table=False
    )
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
    """All balls between the big bin's walls, 13 to 25 cm above the ground."""
    X_BT = scene.pose("dustbin").inverse()
    for name in BALLS:
        along, height, across = (X_BT @ scene.pose(name)).p
        if not (abs(along) < 0.325 and abs(across) < 0.221 and 0.13 < height < 0.25):
            return False
    return True


def held_up(scene: Scene) -> bool:
    """The small bin at least 1 m above the ground, in a hand."""
    up = (scene.pose("dustbin").inverse() @ scene.pose("bin")).p[1] > 1.0
    return bool(up) and scene.touching("left_gripper", "bin")


def tipped(scene: Scene, hand: Pose) -> list[Pose]:
    """ee poses from which the bin's mouth hangs over the big bin, best 57 deg below level."""
    forward = quat_multiply(POUR, axis_angle((1, 0, 0), np.pi))
    bin_ = scene.pose("bin")
    rim = (bin_.inverse() @ scene.contact("bin")).p[1]
    mouth = (hand.inverse() @ bin_ @ Pose((0.0, rim, 0.0))).p  # as seen from the hand
    ways = (
        (place, Pose((0, 0, 0), quat_multiply(axis_angle((0, 0, 1), yaw), quat_multiply(down, q))))
        for down in (axis_angle((1, 0, 0), angle) for angle in STEEPER)
        for place in np.array(OVER)
        for yaw in (0.0, 0.4, -0.4)
        for q in (forward, POUR)
    )
    return [Pose(place - turn.R @ mouth, turn.q) for place, turn in ways]


def script(robot: Robot) -> None:
    left, right, scene = robot.left, robot.right, robot.scene
    away: tuple[Motion, ...] = ()
    if scene.pose("bin").p[0] > 0:
        robot.do(right.grasp("bin", pre=0.08, aim=Aim(MIDDLES[0], None, STAND)))
        robot.do(right.lift(0.06))
        robot.do(place_at_first(right, "bin", MIDDLES, STAND))
        robot.do(right.retreat(0.1))
        away = (right.home(),)
    robot.do(left.grasp("bin", pre=0.08), *away)
    robot.do(left.lift(0.1))
    robot.do(left.reach(*tipped(scene, left.ee())))
    hand = left.ee()
    for roll in ROLLS:  # balls come to lie on the finger inside
        rolled = (Pose(hand.p, quat_multiply(hand.q, axis_angle((1, 0, 0), r))) for r in roll)
        robot.tried(lambda rolled=rolled: robot.do(left.reach(*rolled)))
        robot.do(left.wait(0.6))
        if all(scene.pose(ball).p[2] < 0.4 for ball in BALLS):
            break
    for _ in range(6):  # they may bounce about below
        robot.do(left.wait(0.3))
        if all(scene.speed(ball) < 0.02 for ball in BALLS):
            return


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
