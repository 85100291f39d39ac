"""A bottle in each hand, brought together in front of the robot: any two bottles."""

from collections.abc import Callable, Iterator

import numpy as np

from rtphys.task import (
    DOWN,
    LEFT,
    RIGHT,
    UP_Z,
    Aim,
    Condition,
    Draw,
    Mesh,
    Motion,
    Placing,
    Pose,
    Robot,
    Scene,
    condition,
    free_of,
    held_by,
    place_at_first,
    upright,
)

PLACES = {LEFT: (-0.06, -0.105, 1.0), RIGHT: (0.06, -0.105, 1.0)}  # [m] of a bottle's middle
ABOVE = 0.89  # [m] at the end
ASIDE = 0.1  # [m] from its place, in x and y
LEAN = 0.7  # [rad] that still counts as upright
_YAW = {LEFT: -0.724, RIGHT: 0.789}  # [rad] about which the spawns turn
APPROACH, LIFT = 0.08, 0.1  # [m] straight on to the bottles; up with them
FARTHER = (0.0, 0.06)  # [m] from the robot than its place: where a bottle may be brought, in turn
_OFFER = Placing(pre=0.0, gap=0.0, release=False)


def two_bottles(draw: Draw, model: Callable[[str], int]) -> Iterator[Mesh]:
    """`left_bottle` and `right_bottle`, each on its side, standing; `model` of a side."""
    for side, x in ((LEFT, (-0.25, -0.05)), (RIGHT, (0.05, 0.25))):
        yaw = (_YAW[side] - 1.0, _YAW[side] + 1.0)
        spot = draw.spot(side, x=x, y=(0.03, 0.23), yaw=yaw)
        pose = spot.pose(UP_Z)
        yield Mesh(name=f"{side}_bottle", category="001_bottle", model=model(side), pose=pose)


def bring_bottles_together(robot: Robot) -> None:
    """Both hands at once: grasp, lift, bring to the middle.

    Raises:
        Infeasible: from the verbs.
    """
    left, right = robot.left, robot.right
    goals = {side: Pose(place, DOWN) for side, place in PLACES.items()}
    robot.do(
        left.grasp("left_bottle", pre=APPROACH, aim=Aim(goals[LEFT], 0, _OFFER)),
        right.grasp("right_bottle", pre=APPROACH, aim=Aim(goals[RIGHT], 0, _OFFER)),
    )
    robot.do(left.lift(LIFT), right.lift(LIFT))
    robot.do(_offer(robot, LEFT), _offer(robot, RIGHT))


def _offer(robot: Robot, side: str) -> Motion:
    """Bring a bottle to its place: plumb, or else as it has swung in the hand."""
    bottle = f"{side}_bottle"
    hanging = robot.scene.functional(bottle, 0).q
    goals = [
        Pose(np.add(PLACES[side], (0.0, farther, 0.0)), q)
        for q in (DOWN, hanging)
        for farther in FARTHER
    ]
    return place_at_first(robot.arm(side), bottle, goals, _OFFER, 0)


def bottles_together() -> Condition:
    """Both near their places and upright in the air, each in its own hand."""
    together = condition("the bottles are together in front", _together)
    for side in (LEFT, RIGHT):
        bottle = f"{side}_bottle"
        together = together & held_by(bottle, side) & free_of(bottle, "table")
        together = together & upright(bottle, axis=1, within=LEAN)
    return together


def _together(scene: Scene) -> bool:
    for side, place in PLACES.items():
        x, y, z = scene.functional(f"{side}_bottle", 0).p
        if abs(x - place[0]) > ASIDE or abs(y - place[1]) > ASIDE or z < ABOVE:
            return False
    return True
