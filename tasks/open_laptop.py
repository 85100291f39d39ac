"""Swing the lid of a laptop further open: a closed hand lifts its free edge along the arc.

Success: the hinge is past 40 % of its range, and a closed hand that points at the lid still touches
it. Upstream asks only that a hand is near.
"""

from math import pi

from rtphys.task import (
    IDENTITY,
    Arm,
    Articulated,
    Draw,
    Robot,
    Scene,
    Task,
    condition,
    joint_beyond,
)

from ._hinges import angle_to, opened_in_time, share_open
from ._lids import hands_at, lever, swing

ENOUGH = 0.52  # share of the range to which the hand goes
DONE = 0.43  # share of the range that is enough: success asks for 0.4
PUSH = 9.0  # [N] on the edge that the hinge's damping may cost: the servos yield 2 mm per newton
DAMPING = 1.0  # [N m s/rad] taken for the hinge's where physics does not vary it
MIN_TIME = 1.5  # [s] of a push
PUSHES, LOOKS = 3, 10  # at most; the second at the lid after each push


def layout(draw: Draw):
    yaw = (pi / 2 - pi / 3, pi / 2 + pi / 3)
    spot = draw.spot("laptop", x=(-0.05, 0.05), y=(-0.1, 0.05), yaw=yaw)
    model = draw.choice("model", *range(11))
    yield Articulated(
        name="laptop", category="015_laptop", model=model, pose=spot.pose(IDENTITY), fixed=True,
        opening=0.2,
    )  # fmt: skip


def hand_at_lid(scene: Scene) -> bool:
    at = hands_at(scene, "laptop")
    return any(scene.touching(f"{side}_gripper", "laptop") for side in at)


def push(robot: Robot, arm: Arm) -> None:
    """Sweep the rest of the arc, no faster than the hinge's damping allows."""
    scene = robot.scene
    damping = scene.physics.scalar("object_joint_damping", DAMPING)
    seconds = angle_to(scene, "laptop", ENOUGH) * damping / (PUSH * lever(scene, "laptop"))
    swing(robot, arm, "laptop", ENOUGH, max(seconds, MIN_TIME))
    opened_in_time(robot, arm, "laptop", DONE, LOOKS)


def script(robot: Robot) -> None:
    facing = robot.scene.pose("laptop").R[0, 0]
    first = robot.left if facing > 0 else robot.right
    second = robot.other(first)
    robot.do(first.close(), second.close())
    for _ in range(PUSHES):
        robot.first_feasible((first, second), lambda arm: push(robot, arm))
        if share_open(robot.scene, "laptop") > DONE:
            return


task = Task(
    layout=layout,
    script=script,
    success=joint_beyond("laptop", 0.4) & condition("a hand is at the lid", hand_at_lid),
    step_limit=700,
    mechanism="articulated: open",
    info={"A": "laptop", "a": "arm:laptop"},
)
