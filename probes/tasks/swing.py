"""Swing the door of a microwave a little way, slowly: how stiff is its hinge?

Success: the hinge is past 12 % of its range.
"""

import numpy as np

from rtphys.task import (
    IDENTITY,
    Articulated,
    Draw,
    Pose,
    Robot,
    Scene,
    Task,
    axis_angle,
    joint_beyond,
    quat_multiply,
)

DOOR, BAR = "link_1", 3  # the door's link; the contact point on its bar
STEEP = 0  # another contact point on the bar, for a hand from above
SHARE, SECONDS = 0.3, 5.0  # of the hinge's range, and how long the swing takes, whatever the hinge
STEPS = 8  # poses along the arc
FOLLOWS = (1.0, 0.7, 0.4, 0.0)  # turn of the hand per turn of the door
ENOUGH = 0.12  # share of the range


def layout(draw: Draw):
    spot = draw.spot("microwave", x=(-0.1, -0.04), y=(0.15, 0.18), yaw=(np.pi / 2, np.pi / 2))
    yield Articulated(
        name="microwave", category="044_microwave", model=0, pose=spot.pose(IDENTITY), fixed=True
    )


def arc(scene: Scene, hand: Pose, follow: float) -> list[Pose]:
    """Poses of the hand along the bar's arc; it turns `follow` times as far as the door."""
    hinge = scene.pose("microwave", DOOR).p
    bar = scene.contact("microwave", BAR).p * (1, 1, 0) + hand.p * (0, 0, 1)
    q, low, high = scene.joint("microwave")
    poses: list[Pose] = []
    for angle in np.linspace(0.0, low + SHARE * (high - low) - q, STEPS):
        door = Pose((0, 0, 0), axis_angle((0, 0, 1), -angle))
        turn = Pose((0, 0, 0), axis_angle((0, 0, 1), -angle * follow))
        bar_then = hinge + door.R @ (bar - hinge)
        poses.append(Pose(bar_then + turn.R @ (hand.p - bar), quat_multiply(turn.q, hand.q)))
    return poses


def script(robot: Robot) -> None:
    arm = robot.left
    robot.do(arm.grasp("microwave", (STEEP, BAR), pre=0.08))
    arcs = [arc(robot.scene, arm.ee(), follow) for follow in FOLLOWS]
    robot.do(arm.sweep(*arcs, seconds=SECONDS, prop="microwave"))
    robot.do(arm.wait(1.0))


task = Task(
    layout=layout,
    script=script,
    success=joint_beyond("microwave", ENOUGH),
    step_limit=300,
    mechanism="probe",
    info={"A": "microwave", "a": "left"},
)
