"""Pull the door of a microwave open by its bar.

Success: the hinge is past 60 % of its range, and the left hand is the one at the door.
"""

import numpy as np

from rtphys.task import (
    IDENTITY,
    Arm,
    Articulated,
    Draw,
    Infeasible,
    Pose,
    Robot,
    Scene,
    Task,
    axis_angle,
    condition,
    joint_beyond,
    quat_multiply,
)

DOOR = "link_1"
STEEP, LEVEL = 0, 3  # contact points on the bar
TCP = 0.12  # [m] ee to TCP
ENOUGH, DONE = 0.72, 0.64  # shares of the range: to which the hand goes, and that are enough
PULL = 6.0  # [N] on the bar that the hinge's damping may cost


def layout(draw: Draw):
    spot = draw.spot("microwave", x=(-0.12, -0.02), y=(0.15, 0.2), yaw=(np.pi / 2, np.pi / 2))
    model = draw.choice("model", 0, 1)
    yield Articulated(
        name="microwave", category="044_microwave", model=model, pose=spot.pose(IDENTITY),
        fixed=True,
    )  # fmt: skip


def share(scene: Scene) -> float:
    q, low, high = scene.joint("microwave")
    return (q - low) / (high - low)


def hand_at_door(scene: Scene) -> bool:
    bar = scene.contact("microwave", LEVEL).p
    return bool(np.linalg.norm(scene.tcp("left").p - bar) < 0.1)


def arc(scene: Scene, hand: Pose, follow: float) -> list[Pose]:
    """Hand poses along the door's arc from now on; the hand turns `follow` times as far."""
    q, low, high = scene.joint("microwave")
    hinge = scene.pose("microwave", DOOR).p
    bar = scene.contact("microwave", LEVEL).p * (1, 1, 0) + hand.p * (0, 0, 1)
    poses = []
    for angle in np.linspace(0.0, low + ENOUGH * (high - low) - q, 12):
        with_door = Pose((0, 0, 0), axis_angle((0, 0, 1), -angle))
        with_hand = Pose((0, 0, 0), axis_angle((0, 0, 1), -angle * follow))
        here = hinge + with_door.R @ (bar - hinge)
        poses.append(Pose(here + with_hand.R @ (hand.p - bar), quat_multiply(with_hand.q, hand.q)))
    return poses


def pull(robot: Robot, arm: Arm) -> None:
    """No faster than the hinge's damping allows."""
    scene = robot.scene
    q, low, high = scene.joint("microwave")
    damping = scene.physics.scalar("object_joint_damping", 0.1)
    radius = float(np.linalg.norm((scene.contact("microwave", LEVEL).p
                                   - scene.pose("microwave", DOOR).p)[:2]))  # fmt: skip
    seconds = (low + ENOUGH * (high - low) - q) * damping / (PULL * radius)
    ways = [arc(scene, arm.ee(), follow) for follow in (1.0, 0.7, 0.4, 0.0, -0.3)]
    robot.do(arm.sweep(*ways, seconds=max(seconds, 2.5), prop="microwave"))


def script(robot: Robot) -> None:
    arm = robot.left
    robot.do(arm.grasp("microwave", (STEEP, LEVEL), pre=0.08))
    pull(robot, arm)
    for _ in range(20):
        if share(robot.scene) > DONE:
            return
        robot.do(arm.wait(0.24))
    raise Infeasible("too_slow", "the door did not follow the hand")


task = Task(
    layout=layout,
    script=script,
    success=joint_beyond("microwave", 0.6)
    & condition("the left hand is at the door", hand_at_door),
    step_limit=1500,
    mechanism="articulated: open",
    info={"A": "microwave", "a": "left"},
)
