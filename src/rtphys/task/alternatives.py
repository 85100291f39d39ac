"""Several goals for one verb: the first that can be reached is taken."""

from collections.abc import Sequence

from rtphys.core.errors import Infeasible
from rtphys.core.poses import Pose
from rtphys.task.arm import Arm, Motion, Placing


def place_at_first(
    arm: Arm, prop: str, goals: Sequence[Pose], how: Placing, point: int | None = None
) -> Motion:
    """`arm.place` at the first of the goals (task frame) that the arm can reach.

    Args:
        point: functional point of the prop that arrives; None: its origin.

    Raises:
        Infeasible: "unreachable", when no goal is.
    """
    for goal in goals:
        try:
            return arm.place(prop, goal, point=point, how=how)
        except Infeasible:
            continue
    raise Infeasible("unreachable", f"the {arm.side} hand finds no place for {prop}")
