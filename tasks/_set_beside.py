"""One thing put directly beside another: what two tasks differ in is the side."""

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
_HOW = Placing(pre=0.08, gap=0.004)


def set_beside(robot: Robot, side: str) -> None:
    """The nearest hand puts `thing` to a side of `other`.

    Raises:
        Infeasible: from the verbs.
    """
    arm, other = robot.nearest("thing"), robot.scene.pose("other").p
    x = other[0] - APART if side == LEFT else other[0] + APART
    place = Pose((x, other[1], TABLE_TOP), IDENTITY)
    robot.do(arm.grasp("thing", pre=0.1, aim=Aim(place, None, _HOW)))
    robot.do(arm.lift(0.1))
    robot.do(arm.place("thing", place, how=_HOW))
    robot.do(arm.retreat(0.06))


def stands_beside(side: str) -> Condition:
    """`thing` on that side of `other`, both at rest on the table, both hands open."""
    found = beside("thing", "other", side) & on_table("thing", "other")
    return found & at_rest("thing") & at_rest("other") & hands_open()
