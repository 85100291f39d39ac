"""Press the lower half of a rocker switch in.

Success: the rocker is within 0.05 rad of its upper stop, and a fingertip of a closed hand has
pressed its lower half. Upstream does not ask for the hand; an external force alone may creep a
loose rocker there within an episode.
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
    pressed,
    quat_multiply,
)

MARGIN = 0.05  # [rad] of the rocker from its stop, at most
NEAR = (0.02, 0.02, 0.02)  # [m] of a finger from the middle of the plate; the expert's is 1.1 cm
ASKEW = 1.1  # [rad] of the hand from straight in; the expert's is 0.9 at most
CLOSE = 0.5 * MARGIN  # [rad] at which the hand need not wait any longer
PUSH = 12.0  # [N] on the rocker that its damping may cost: the servos yield 2 mm per newton
LEVER = 0.025  # [m] of the push about the rocker's hinge
LEAN = 0.03  # [m] commanded past the plate at most, where the rocker needs so much
ADVANCE = 0.003  # [m] a step of the push
PITCHES = (0.0, 0.2, -0.2, 0.4)  # [rad] of the hand: level where that is in reach
CLEAR = 0.08  # [m] TCP to switch before the push
WAITS, WAIT = 30, 0.3  # number at most, and [s] each: a stiff rocker follows the hand late


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


def pushing_paths(scene: Scene, arm: Arm) -> list[list[Pose]]:
    """Hand poses before the plate and at it, the straightest first."""
    point, hand = scene.contact("switch"), arm.hand
    level = Pose.from_matrix(np.column_stack([-point.R[:, 1], -point.R[:, 2], point.R[:, 0]]))
    paths = []
    for pitch in PITCHES:
        pitched = Pose(point.p, quat_multiply(level.q, axis_angle((0, 1, 0), pitch)))
        distances = (CLEAR + hand.tcp, hand.tip)
        paths.append([pitched.moved(-distance * pitched.R[:, 0]) for distance in distances])
    return paths


def push(robot: Robot, arm: Arm) -> None:
    """Push the rocker in, no faster than its damping allows."""
    damping = robot.scene.physics.scalar("object_joint_damping", 0.0)
    robot.do(arm.sweep(*pushing_paths(robot.scene, arm), prop="switch"))
    pushed, pause = 0.0, damping * ADVANCE / (PUSH * LEVER**2)
    while pushed < LEAN and left_to_go(robot.scene) > CLOSE:
        robot.do(arm.advance(ADVANCE), arm.wait(pause))
        pushed += ADVANCE


def script(robot: Robot) -> None:
    first = robot.right if robot.scene.pose("switch").R[0, 0] < 0 else robot.left
    second = robot.other(first)
    robot.do(first.close(), second.close())
    arm = robot.first_feasible((first, second), lambda arm: push(robot, arm))
    if arm is None:
        raise Infeasible("unreachable", "no hand can push the rocker straight in")
    for _ in range(WAITS):
        if left_to_go(robot.scene) < CLOSE:
            return
        robot.do(arm.wait(WAIT))
    if left_to_go(robot.scene) > MARGIN:
        raise Infeasible("too_slow", "the rocker did not reach its stop")


task = Task(
    layout=layout,
    script=script,
    success=condition("the rocker is at its upper stop", lambda s: left_to_go(s) < MARGIN)
    & pressed("switch", contact=0, within=NEAR, tilted_below=ASKEW),
    step_limit=400,
    mechanism="press articulated",
    info={"A": "switch", "a": "arm:switch"},
)
