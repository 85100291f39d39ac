"""One hand holds a skillet up before the robot, the other lays the bread into its pan.

Success: the bread lies in the pan, the pan is in a hand and off the table, the bread in none.
"""

import numpy as np

from rtphys.task import (
    DOWN,
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
    quat_multiply,
    touching,
    yawed,
)

INTO = Placing(mode="free", pre=0.08, gap=0.012, along="point")
SAG = 0.06  # [rad] of the pan that is corrected
TCP, FINGER, HALF_PAD = 0.12, 0.0356, 0.0305  # [m] ee to TCP, TCP to fingertips, pad's half width
SLOWLY = 0.5  # share of the usual speed: shaken less, the pan turns less in the hand
ABOVE = 0.2  # [m] lift of the bread: from lower down, its way to the pan grazes the rim
HEIGHT = 0.86  # [m] of the pan's floor
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
    return bool(abs(gap[0]) < 0.035 and abs(gap[1]) < 0.035 and -0.02 < gap[2] < 0.05)


def held_up(scene: Scene) -> bool:
    hand = any(scene.touching(f"{side}_gripper", "skillet") for side in ("left", "right"))
    up = scene.functional("skillet", 0).p[2] > 0.76 and scene.pose("bread").p[2] > 0.76
    return bool(hand and up and not scene.touching("skillet", "table"))


def tilted_holds(scene: Scene) -> list[list[Pose]]:
    """Ways to take the handle with a tilted hand, in which the pan sagged least when tried."""
    point = scene.contact("skillet", 0)
    straight = Pose.from_matrix(np.column_stack([-point.R[:, 1], -point.R[:, 2], point.R[:, 0]]))
    found = []
    for tilt in (0.48, 0.4, 0.3, 0.2, 0.0):
        hand = Pose((0, 0, 0), quat_multiply(straight.q, axis_angle((0, 1, 0), -tilt)))
        x = hand.R[:, 0]
        tip = point.p + FINGER * x
        missing = 0.744 + HALF_PAD * abs(hand.R[2, 2]) - tip[2]
        at = hand.moved(point.p - (TCP + max(missing, 0.0) / -x[2]) * x)
        found.append([at.moved(-0.07 * x), at])
    return found


def level(scene: Scene, x: float, y: float, yaw: float) -> Pose:
    """Frame of the skillet whose pan is level at (x, y), turned by `yaw` from the spawn pose."""
    X_SF = scene.pose("skillet").inverse() @ scene.functional("skillet", 0)
    q = yawed(UP_F, yaw)
    return Pose(np.array([x, y, HEIGHT]) - Pose((0, 0, 0), q).R @ X_SF.p, q)


def lay(robot: Robot, arm: Arm) -> bool:
    """Put the bread into the pan with a hand that leans forward as little as it can."""
    floor = robot.scene.functional("skillet", 0).p
    for tilt in (0.2, 0.4, 0.6):
        goal = Pose(floor, quat_multiply(axis_angle((1, 0, 0), tilt), DOWN))
        if robot.tried(lambda goal=goal: robot.do(arm.place("bread", goal, how=INTO))):
            return True
    return False


def present(robot: Robot, holder: Arm, other: Arm) -> bool:
    """Hold the pan where the other hand can lay something into it, and do so."""
    side = -1.0 if holder.side == "left" else 1.0
    for x, y in ((-0.05, -0.13), (0.0, -0.15), (-0.1, -0.13)):
        for yaw in (1.57, 1.2, 0.8):
            goal = side * x, y, side * yaw

            def hold(goal=goal) -> None:
                robot.do(holder.carry("skillet", [level(robot.scene, *goal)], speed=SLOWLY))

            if robot.tried(hold):
                if robot.scene.functional("skillet", 0).R[2, 2] < np.cos(SAG):
                    robot.tried(hold)  # its weight turned it in the hand
                if lay(robot, other):
                    return True
    return False


def script(robot: Robot) -> None:
    holder, other = robot.nearest("skillet"), robot.nearest("bread")

    def take() -> None:
        robot.do(holder.sweep(*tilted_holds(robot.scene), prop="skillet"))
        robot.do(holder.close(holds="skillet"))
        robot.do(holder.lift(0.04))

    robot.retake(take)
    robot.do(other.grasp("bread", pre=0.07))
    robot.do(holder.lift(0.1), other.lift(ABOVE))
    if not present(robot, holder, other):
        raise Infeasible("unreachable", "the hands cannot bring pan and bread together")
    robot.do(other.lift(0.06))


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
