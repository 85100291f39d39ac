"""Which two bodies are checked against each other, and how near they may come."""

from collections.abc import Sequence
from dataclasses import dataclass, field
from itertools import combinations

import numpy as np

from rtphys.core.poses import Array
from rtphys.plan.robot_shapes import STATIC, RobotShapes, Side

OBSTACLE = "obstacle"

# Least distances [m]. A negative one allows that much overlap.
ARM_MARGIN = 0.005  # arm links and the hand's body to the surroundings and the other arm
FINGER_MARGIN = 0.0015  # fingers to anything; grasps keep 2 mm to the table, servo error takes some
SELF_MARGIN = 0.0  # links of one arm
CARRIED_MARGIN = 0.003  # a carried body to the robot and to what the other hand carries
RESTING_MARGIN = -0.002  # a carried body to obstacles: it starts and ends in contact with them


@dataclass(frozen=True)
class Body:
    """One geometry. `owner`: "left", "right", "static" or "obstacle"; `carried`: in that hand."""

    name: str
    owner: str
    hand: bool = False  # part of the hand, see `Shape`
    finger: bool = False
    carried: bool = False


@dataclass
class Rules:
    """What the caller may change about pairs."""

    ignored: set[tuple[Side, str]] = field(default_factory=set)
    carried_margin: float = RESTING_MARGIN  # [m]


def robot_bodies(robot: RobotShapes) -> list[Body]:
    """The robot's own shapes, in their order."""
    return [Body(s.link, s.owner, s.hand, s.finger) for s in robot.shapes]


def robot_pairs(robot: RobotShapes) -> list[tuple[int, int]]:
    """Pairs of the robot's own shapes that can meet: no neighbours, nothing out of reach."""
    balls = [robot.reach(shape) for shape in robot.shapes]
    pairs = []
    for i, j in combinations(range(len(robot.shapes)), 2):
        a, b = robot.shapes[i], robot.shapes[j]
        if a.owner == b.owner == STATIC:
            continue
        gap = float(np.linalg.norm(balls[i][0] - balls[j][0]))
        if gap > balls[i][1] + balls[j][1] + ARM_MARGIN:
            continue
        if a.owner == b.owner and abs(a.depth - b.depth) <= 1:
            continue
        pairs.append((i, j))
    return pairs


def own_margins(bodies: Sequence[Body], pairs: Sequence[tuple[int, int]]) -> Array:
    """Least distance of the pairs of the robot's own n shapes (n, n) [m], NaN for all others."""
    table = np.full((len(bodies), len(bodies)), np.nan)
    for i, j in pairs:
        a, b = bodies[i], bodies[j]
        between = FINGER_MARGIN if a.finger or b.finger else ARM_MARGIN
        table[i, j] = SELF_MARGIN if a.owner == b.owner else between
    return table


def margins(bodies: Sequence[Body], own: Array, rules: Rules) -> Array:
    """Least distance of every pair (i < j), NaN where a pair is not checked.

    Args:
        bodies: n bodies, the robot's own shapes first, then obstacles, then carried bodies.
        own: margins of the robot's own shapes, see `own_margins`.
        rules: what the caller changed.

    Returns:
        (n, n) [m].
    """
    n = len(own)
    table = np.full((len(bodies), len(bodies)), np.nan)
    table[:n, :n] = own
    table[:, n:] = _item_margins(bodies, n, rules)
    table[n:, n:][np.tri(len(bodies) - n, dtype=bool)] = np.nan
    return table


def _item_margins(bodies: Sequence[Body], own: int, rules: Rules) -> Array:
    """Columns of the table for what is not the robot's (n, n - own); all at once, for speed."""
    owner = np.array([body.owner for body in bodies])
    name = np.array([body.name for body in bodies])
    hand = np.array([body.carried or body.hand for body in bodies])
    carried = np.array([body.carried for body in bodies])
    finger = np.array([body.finger for body in bodies])
    still, obstacle = (owner == OBSTACLE) | (owner == STATIC), owner == OBSTACLE

    loaded = carried[:, None] | carried[own:]
    resting = obstacle[:, None] | obstacle[own:]
    margin = np.where(finger, FINGER_MARGIN, ARM_MARGIN)[:, None] + np.zeros(len(bodies) - own)
    margin[loaded] = CARRIED_MARGIN
    margin[loaded & resting] = rules.carried_margin
    unchecked = still[:, None] & still[own:]
    unchecked |= (owner[:, None] == owner[own:]) & hand[:, None] & hand[own:]
    # Two hands on one body: each may touch the body that the other one carries.
    carried_by = {(body.owner, body.name) for body in bodies if body.carried}
    for side, touched in rules.ignored | carried_by:
        fingers, body = hand & (owner == side), name == touched
        unchecked |= fingers[:, None] & body[own:] | body[:, None] & fingers[own:]
    margin[unchecked] = np.nan
    return margin
