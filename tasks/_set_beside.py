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
    at_rest,
    beside,
    hands_open,
    on_table,
)

APART = 0.16  # [m] room for open fingers between the two
LIFT, RETREAT = 0.1, 0.06  # [m] up with the thing; off it
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
    """`thing` on that side of `other`, both at rest on the table, both hands open."""
    stands = beside("thing", "other", side) & on_table("thing", "other")
    return stands & at_rest("thing") & at_rest("other") & hands_open()
