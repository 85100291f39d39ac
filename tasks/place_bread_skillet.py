"""One hand holds a skillet up before the robot, the other lays the bread into its pan.

Success: the bread lies in the pan, the pan is in a hand and off the table, the bread in none.
"""

from functools import partial
from itertools import product

import numpy as np

from rtphys.task import (
    DOWN,
    TABLE_TOP,
    UP_F,
    UP_Z,
    Arm,
    Draw,
    Infeasible,
    Mesh,
    Placing,
    Pose,
    Robot,
    Scene,
    Task,
    axis_angle,
    condition,
    free_of,
    in_hand,
    quat_multiply,
    touching,
    yawed,
)

INTO = Placing(mode="free", pre=0.08, gap=0.012, along="point")
SAG = 0.06  # [rad] of the pan that is corrected
SLOWLY = 0.5  # share of the usual speed: shaken less, the pan turns less in the hand
APPROACH, LIFT = 0.07, 0.1  # [m] straight on to pan and bread; up with the pan, to hold it out
FREE = 0.04  # [m] lift that frees the pan from the table
ABOVE = 0.2  # [m] lift of the bread: from lower down, its way to the pan grazes the rim
RETREATS = (0.06, 0.04, 0.025)  # [m] up from the bread that was laid, or back
HEIGHT = 0.86  # [m] of the pan's floor
# [m] where the pan is held out, on the holder's side, and [rad] how it is turned there
PLACES = ((-0.05, -0.13), (0.0, -0.15), (-0.1, -0.13))
YAWS = (1.57, 1.2, 0.8)
TILTS = (
    0.48,
    0.4,
    0.3,
    0.2,
    0.0,
)  # [rad] of the hand at the handle: the pan sags least in the first
LEANS = (0.2, 0.4, 0.6)  # [rad] forward, of the hand that lays the bread: as little as it can
CLEAR = TABLE_TOP + 0.004  # [m] lowest height of a finger at the handle
MIDDLE, DEPTH = 0.035, (-0.02, 0.05)  # [m] of the bread from the middle of the pan: across, up
HELD_UP = TABLE_TOP + 0.02  # [m] height of pan and bread, at least
# A toy pan and dry bread: by its handle a hand can hardly keep heavier ones level.
PAN_KG, BREAD_KG = 0.12, 0.01  # [kg]


def layout(draw: Draw):
    side = draw.choice("side", -1, 1)  # of the bread
    x = (0.2, 0.28) if side > 0 else (-0.28, -0.2)
    bread = draw.spot("bread", x=x, y=(-0.2, 0.05), yaw=(-0.785, 0.785))
    model = draw.choice("bread model", 0, 1, 3, 5, 6)
    yield Mesh(
        name="bread",
        category="075_bread",
        model=model,
        pose=bread.pose(UP_Z),
        mass_kg=BREAD_KG,
    )
    x = (-0.25, -0.15) if side > 0 else (0.15, 0.25)
    pan = draw.spot("skillet", x=x, y=(-0.2, 0.05), yaw=(-0.524, 0.524))
    model = draw.choice("skillet model", *range(4))
    yield Mesh(
        name="skillet",
        category="106_skillet",
        model=model,
        pose=pan.pose(UP_F),
        mass_kg=PAN_KG,
    )


def in_pan(scene: Scene) -> bool:
    gap = scene.pose("bread").p - scene.functional("skillet", 0).p
    return bool(max(abs(gap[:2])) < MIDDLE and DEPTH[0] < gap[2] < DEPTH[1])


def held_up(scene: Scene) -> bool:
    up = min(scene.functional("skillet", 0).p[2], scene.pose("bread").p[2]) > HELD_UP
    return bool(in_hand(scene, "skillet") and up and not scene.touching("skillet", "table"))


def tilted_holds(scene: Scene, arm: Arm) -> list[list[Pose]]:
    """Ways to take the handle with a tilted hand."""
    point, measures = scene.contact("skillet", 0), arm.hand
    straight = Pose.from_matrix(np.column_stack([-point.R[:, 1], -point.R[:, 2], point.R[:, 0]]))
    ways: list[list[Pose]] = []
    for tilt in TILTS:
        hand = Pose((0, 0, 0), quat_multiply(straight.q, axis_angle((0, 1, 0), -tilt)))
        x = hand.R[:, 0]
        tip = point.p + measures.fingertip * x
        missing = CLEAR + measures.pad_half_width * abs(hand.R[2, 2]) - tip[2]
        at = hand.moved(point.p - (measures.tcp + max(missing, 0.0) / -x[2]) * x)
        ways.append([at.moved(-APPROACH * x), at])
    return ways


def level(scene: Scene, x: float, y: float, yaw: float) -> Pose:
    """Frame of the skillet whose pan is level at (x, y), turned by `yaw` from the spawn pose."""
    X_SF = scene.pose("skillet").inverse() @ scene.functional("skillet", 0)
    q = yawed(UP_F, yaw)
    return Pose(np.array([x, y, HEIGHT]) - Pose((0, 0, 0), q).R @ X_SF.p, q)


def lay(robot: Robot, arm: Arm) -> bool:
    """Put the bread into the pan; whether the hand finds a way."""
    floor = robot.scene.functional("skillet", 0).p

    def lay_leaning(lean: float) -> None:
        goal = Pose(floor, quat_multiply(axis_angle((1, 0, 0), lean), DOWN))
        robot.do(arm.place("bread", goal, how=INTO))

    return robot.first_feasible(LEANS, lay_leaning) is not None


def present(robot: Robot, holder: Arm, other: Arm) -> bool:
    """Hold the pan where the other hand can lay something into it, and do so."""
    side = -1.0 if holder.side == "left" else 1.0

    def hold(x: float, y: float, yaw: float) -> None:
        robot.do(holder.carry("skillet", [level(robot.scene, x, y, yaw)], speed=SLOWLY))

    for (x, y), yaw in product(PLACES, YAWS):
        hold_there = partial(hold, side * x, y, side * yaw)
        if robot.tried(hold_there):
            if robot.scene.functional("skillet", 0).R[2, 2] < np.cos(SAG):
                robot.tried(hold_there)  # its weight turned it in the hand
            if lay(robot, other):
                return True
    return False


def script(robot: Robot) -> None:
    holder, other = robot.nearest("skillet"), robot.nearest("bread")

    def take() -> None:
        robot.do(holder.sweep(*tilted_holds(robot.scene, holder), prop="skillet"))
        robot.do(holder.close(holds="skillet"))
        robot.do(holder.lift(FREE))

    robot.retake(take)
    robot.do(other.grasp("bread", pre=APPROACH))
    robot.do(holder.lift(LIFT), other.lift(ABOVE))
    if not present(robot, holder, other):
        raise Infeasible("unreachable", "the hands cannot bring pan and bread together")
    ways = [way(distance) for distance in RETREATS for way in (other.lift, other.retreat)]
    if robot.first_feasible(ways, robot.do) is None:
        raise Infeasible("unreachable", "no way off the pan")


task = Task(
    layout=layout,
    script=script,
    success=condition("the bread is in the pan", in_pan)
    & condition("the pan is held up", held_up)
    & touching("bread", "skillet")
    & free_of("bread", "left_gripper", "right_gripper", "table"),
    step_limit=500,
    arms="dual",
    mechanism="hold, drop in",
    info={"A": "skillet", "B": "bread", "a": "arm:skillet"},
)
