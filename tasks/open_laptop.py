"""Swing the lid of a laptop further open: a closed hand lifts its free edge along the arc.

Success: the hinge is past 40 % of its range, and the hand that pushed is still at the lid.
"""

from math import cos, pi, sin

import numpy as np

from rtphys.task import (
    IDENTITY,
    Arm,
    Articulated,
    Draw,
    Pose,
    Robot,
    Scene,
    Task,
    axis_angle,
    condition,
    joint_beyond,
    quat_multiply,
)

LID = "link_1"
EDGE, CARROT = 0, 1  # contact points: the lid's free edge, and 2-3 cm further open
ENOUGH = 0.52  # share of the range to which the hand goes
DONE = 0.43  # share of the range that is enough: success asks for 0.4
PUSH = 9.0  # [N] on the edge that the hinge's damping may cost: the servos yield 2 mm per newton
FINGER = np.array([0.143, 0.0, 0.012])  # [m] ee frame: where the edge lies on the closed fingers


def layout(draw: Draw):
    yaw = (pi / 2 - pi / 3, pi / 2 + pi / 3)
    spot = draw.spot("laptop", x=(-0.05, 0.05), y=(-0.1, 0.05), yaw=yaw)
    model = draw.choice("model", *range(11))
    yield Articulated(
        name="laptop", category="015_laptop", model=model, pose=spot.pose(IDENTITY), fixed=True,
        opening=0.2,
    )  # fmt: skip


def hand_at_lid(scene: Scene) -> bool:
    edge = scene.contact("laptop", CARROT).p
    gaps = [((scene.tcp(side).p - edge) ** 2).sum() ** 0.5 for side in ("left", "right")]
    return min(gaps) < 0.1


def arc(scene: Scene, pitch: float, turn: float, aside: float) -> list[Pose]:
    """ee poses that carry the edge from just below it to ENOUGH, hand pitched down and turned."""
    X_TL, X_TE = scene.pose("laptop", LID), scene.contact("laptop", EDGE)
    q, low, high = scene.joint("laptop")
    hinge = scene.contact("laptop", EDGE).R[:, 0]
    heading = (
        np.cross(hinge, (0, 0, 1))
        if scene.pose("laptop").R[:, 0] @ np.cross(hinge, (0, 0, 1)) > 0
        else np.cross((0, 0, 1), hinge)
    )
    x = cos(pitch) * heading - sin(pitch) * np.array([0, 0, 1.0])
    side = np.cross(np.array([0, 0, 1.0]), heading)
    hand = Pose.from_matrix(np.column_stack([x, side, np.cross(x, side)]))
    hand = Pose((0, 0, 0), quat_multiply(axis_angle((0, 0, 1), turn), hand.q))
    arm_ = X_TE.p - X_TL.p
    axis = np.cross((0, 0, 1), heading)  # opens: the edge rises
    poses = []
    for angle in np.linspace(0.0, low + ENOUGH * (high - low) - q, 12):
        edge = X_TL.p + Pose((0, 0, 0), axis_angle(axis, angle)).R @ arm_ + aside * side
        poses.append(Pose(edge - hand.R @ FINGER, hand.q))
    below = poses[0].moved(-0.025 * hand.R[:, 2])
    return [below, *poses]


def share(scene: Scene) -> float:
    q, low, high = scene.joint("laptop")
    return (q - low) / (high - low)


def push(robot: Robot, arm: Arm) -> None:
    """Sweep the rest of the arc, no faster than the hinge's damping allows."""
    scene = robot.scene
    q, low, high = scene.joint("laptop")
    damping = scene.physics.scalar("object_joint_damping", 1.0)
    radius = float(np.linalg.norm(scene.contact("laptop", EDGE).p - scene.pose("laptop", LID).p))
    seconds = (low + ENOUGH * (high - low) - q) * damping / (PUSH * radius)
    ways = [
        arc(scene, pitch, turn, aside)
        for pitch in (0.8, 0.6, 1.0)
        for turn in (0.0, 0.3, -0.3, 0.6, -0.6)
        for aside in (0.0, 0.04, -0.04)
    ]
    robot.do(arm.sweep(*ways, seconds=max(seconds, 1.5), prop="laptop"))
    for _ in range(10):  # a stiff hinge follows the hand late
        if share(scene) > DONE:
            break
        robot.do(arm.wait(0.24))


def script(robot: Robot) -> None:
    facing = robot.scene.pose("laptop").R[0, 0]
    first = robot.left if facing > 0 else robot.right
    robot.do(first.close(), robot.other(first).close())
    for _ in range(3):
        for arm in (first, robot.other(first)):
            if robot.tried(lambda arm=arm: push(robot, arm)):
                break
        if share(robot.scene) > DONE:
            return


task = Task(
    layout=layout,
    script=script,
    success=joint_beyond("laptop", 0.4) & condition("a hand is at the lid", hand_at_lid),
    step_limit=700,
    mechanism="articulated: open",
    info={"A": "laptop", "a": "arm:laptop"},
)
