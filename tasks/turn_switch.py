"""Press the lower half of a rocker switch in.

Success: the rocker is within 0.05 rad of its upper stop, and a hand has been on it. Upstream does
not ask for the hand; an external force alone may creep a loose rocker there within an episode.
"""

from math import pi

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
    quat_multiply,
)

MARGIN = 0.05  # [rad]
PUSH = 12.0  # [N] on the rocker that its damping may cost: the servos yield 2 mm per newton
LEAN = 0.03  # [m] commanded past the plate, so that the last of the way is pushed with 15 N
CLEAR = 0.08  # [m] TCP to switch before the push
TCP, FINGER = 0.12, 0.0356  # [m] ee to TCP, TCP to fingertips
LEVER = 0.025  # [m] about the rocker's hinge


def layout(draw: Draw):
    yaw = (pi / 2 - pi / 4, pi / 2 + pi / 4)
    spot = draw.spot("switch", x=(-0.25, 0.25), y=(0.0, 0.1), yaw=yaw)
    pose = spot.pose(IDENTITY, z=draw.uniform("height", 0.81, 0.84))
    model = draw.choice("model", *range(8))
    yield Articulated(
        name="switch", category="056_switch", model=model, pose=pose, fixed=True, resting=False
    )


def left_to_go(scene: Scene) -> float:
    """Angle from the rocker to its upper stop [rad]."""
    q, _, high = scene.joint("switch")
    return high - q


def ways(scene: Scene) -> list[list[Pose]]:
    """Straight into the plate from CLEAR before it; pitched only where level is out of reach."""
    point = scene.contact("switch", 0)
    found = []
    for lean in (LEAN, 0.6 * LEAN):
        for pitch in (0.0, 0.2, -0.2, 0.4):
            level = Pose.from_matrix(
                np.column_stack([-point.R[:, 1], -point.R[:, 2], point.R[:, 0]])
            )
            q = quat_multiply(level.q, axis_angle((0, 1, 0), pitch))
            at = Pose(point.p, q)
            steps = (CLEAR + TCP, TCP + FINGER - lean)
            found.append([at.moved(-step * at.R[:, 0]) for step in steps])
    return found


def push(robot: Robot, arm: Arm) -> None:
    """No faster than the damping allows."""
    damping = robot.scene.physics.scalar("object_joint_damping", 0.0)
    seconds = left_to_go(robot.scene) * damping / (PUSH * LEVER)
    robot.do(arm.sweep(*ways(robot.scene), seconds=max(seconds, 0.8), prop="switch"))


def script(robot: Robot) -> None:
    first = robot.right if robot.scene.pose("switch").R[0, 0] < 0 else robot.left
    robot.do(first.close(), robot.other(first).close())
    for arm in (first, robot.other(first)):
        if robot.tried(lambda arm=arm: push(robot, arm)):
            break
    else:
        raise Infeasible("unreachable", "no hand can push the rocker straight in")
    for _ in range(30):  # a stiff rocker follows the hand late
        if left_to_go(robot.scene) < 0.5 * MARGIN:
            return
        robot.do(arm.wait(0.3))
    if left_to_go(robot.scene) > MARGIN:
        raise Infeasible("too_slow", "the rocker did not reach its stop")


def pushed(scene: Scene) -> bool:
    """Whether a hand has touched the switch."""
    hands = any(scene.touching(f"{side}_gripper", "switch") for side in ("left", "right"))
    return scene.once("a hand on the switch", hands)


task = Task(
    layout=layout,
    script=script,
    success=condition("the rocker is at its upper stop", lambda s: left_to_go(s) < MARGIN)
    & condition("a hand has been on the switch", pushed, remembers=True),
    step_limit=400,
    mechanism="press articulated",
    info={"A": "switch", "a": "arm:switch"},
)
