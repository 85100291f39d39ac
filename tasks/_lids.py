"""Lids of laptops: the arc along which a closed hand lifts their free edge, and who does."""

from itertools import product
from math import cos, sin

import numpy as np

from rtphys.task import LEFT, RIGHT, Arm, Pose, Robot, Scene, axis_angle, quat_multiply

from ._hinges import angle_to

LID = "link_1"
EDGE = 0  # contact point: the lid's free edge
BEYOND, UPON = 0.023, 0.012  # [m] the TCP, along its x and z: where the edge lies on the fingers
BELOW = 0.025  # [m] from the hand to the edge before it meets it
STEPS = 12  # poses along the arc
PITCHES = (0.8, 0.6, 1.0)  # [rad] of the hand below level
TURNS = (0.0, 0.3, -0.3, 0.6, -0.6)  # [rad] of the hand about the vertical, from square to the edge
ASIDES = (0.0, 0.04, -0.04)  # [m] along the edge, from its middle
CARROT = 1  # contact point 2-3 cm further open than the lid's free edge
AT_LID = 0.07  # [m] from the TCP to CARROT, at most; the expert's is 4 to 6 cm
ASKEW = 1.3  # [rad] of the hand from straight at the lid, at most; the expert's is 1.1
CLOSED = 0.1  # opening of the gripper, at most; the expert's is 0


def arc(
    scene: Scene, laptop: str, share: float, reach: float, pitch: float, turn: float, aside: float
) -> list[Pose]:
    """ee poses that carry the edge from just below it to a share, hand pitched down and turned.

    Args:
        share: of the hinge's range.
        reach: ee to TCP [m].
    """
    X_TL, X_TE = scene.pose(laptop, LID), scene.contact(laptop, EDGE)
    hinge, up = X_TE.R[:, 0], np.array([0, 0, 1.0])
    heading = np.cross(hinge, up)
    if scene.pose(laptop).R[:, 0] @ heading <= 0:
        heading = np.cross(up, hinge)
    x = cos(pitch) * heading - sin(pitch) * up
    side = np.cross(up, heading)
    square = Pose.from_matrix(np.column_stack([x, side, np.cross(x, side)]))
    hand = Pose((0, 0, 0), quat_multiply(axis_angle((0, 0, 1), turn), square.q))
    on_fingers = np.array([reach + BEYOND, 0.0, UPON])
    lever = X_TE.p - X_TL.p
    poses: list[Pose] = []
    for angle in np.linspace(0.0, angle_to(scene, laptop, share), STEPS):
        # About `side` the edge rises.
        edge = X_TL.p + Pose((0, 0, 0), axis_angle(side, angle)).R @ lever + aside * side
        poses.append(Pose(edge - hand.R @ on_fingers, hand.q))
    return [poses[0].moved(-BELOW * hand.R[:, 2]), *poses]


def lever(scene: Scene, laptop: str) -> float:
    """From the hinge to the lid's free edge [m]."""
    return float(np.linalg.norm(scene.contact(laptop, EDGE).p - scene.pose(laptop, LID).p))


def swing(robot: Robot, arm: Arm, laptop: str, share: float, seconds: float) -> None:
    """Sweep the lid's edge along the first arc that is reachable, to a share of its range."""
    shapes = product(PITCHES, TURNS, ASIDES)
    arcs = [arc(robot.scene, laptop, share, arm.hand.tcp, *shape) for shape in shapes]
    robot.do(arm.sweep(*arcs, seconds=seconds, prop=laptop))


def hands_at(scene: Scene, laptop: str) -> list[str]:
    """Sides whose hand is closed, near the lid's edge, and points at it."""
    return [side for side in (LEFT, RIGHT) if _is_at(scene, laptop, side)]


def _is_at(scene: Scene, laptop: str, side: str) -> bool:
    edge, tcp = scene.contact(laptop, CARROT), scene.tcp(side)
    near = np.linalg.norm(tcp.p - edge.p) < AT_LID
    straight = -(tcp.R[:, 0] @ edge.R[:, 1]) > cos(ASKEW)
    return bool(near and straight) and scene.opening(side) < CLOSED
