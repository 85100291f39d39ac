"""One thing is put directly to the left or right of another."""

from rtphys.task import (
    IDENTITY,
    LEFT,
    TABLE_TOP,
    Aim,
    Condition,
    Placing,
    Pose,
    Robot,
    Scene,
    at_rest,
    beside,
    condition,
    hands_open,
    in_hand,
    on_table,
)

APART = 0.16  # [m] room for open fingers between the two
LIFT, RETREAT = 0.1, 0.06  # [m] up with the thing; off it
LIFTED = 0.03  # [m] off the table, at least, to be put down rather than pushed
_HOW = Placing(pre=0.08, gap=0.004)


def set_beside(robot: Robot, side: str) -> None:
    """The nearest hand puts `thing` to a side of `other`.

    Raises:
        Infeasible: from the verbs.
    """
    arm, other = robot.nearest("thing"), robot.scene.pose("other").p
    x = other[0] - APART if side == LEFT else other[0] + APART
    place = Pose((x, other[1], TABLE_TOP), IDENTITY)
    robot.do(arm.grasp("thing", aim=Aim(place, None, _HOW)))
    robot.do(arm.lift(LIFT))
    robot.do(arm.place("thing", place, how=_HOW))
    robot.do(arm.retreat(RETREAT))


def stands_beside(side: str) -> Condition:
    """A hand lifted `thing`; now it is on that side of `other`, both at rest, both hands open."""
    stands = beside("thing", "other", side) & on_table("thing", "other")
    at_last = stands & at_rest("thing") & at_rest("other") & hands_open()
    return at_last & condition("a hand lifted the thing", lifted_once, remembers=True)


def lifted_once(scene: Scene) -> bool:
    """Random motion pushed one thing of 50 to its place, and lifts none."""
    up = scene.lowest("thing") > TABLE_TOP + LIFTED
    return scene.once("thing lifted", bool(up) and in_hand(scene, "thing"))
