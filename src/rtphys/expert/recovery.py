"""One second try when a hand has lost what it took: let go, back off, take it again."""

from collections.abc import Callable
from typing import TYPE_CHECKING

from rtphys.assets.action_layout import SIDES
from rtphys.core.errors import Infeasible

if TYPE_CHECKING:
    from rtphys.expert.robot import ExpertRobot

LOST = frozenset({"slipped", "grasp_missed"})  # reasons that a second try may cure
BACK_OFF = 0.08  # [m] the way a hand came in to grasp
CALM = 0.4  # [s] for what was dropped to come to rest
PLANNING = frozenset({"unreachable", "no_path", "retime_failed", "ungraspable"})
CLOSED = 0.3  # commanded opening; hands that are made slim for a purpose stay wider
CARE = 0.6  # share of the first pace with which a load is carried that slipped once


def retake(robot: "ExpertRobot", action: Callable[[], None]) -> None:
    """Run `action`; once in an episode, run it again when its load was lost.

    Raises:
        Infeasible: "recovered", when a second try is due but not allowed; else what the action,
            or its second try, raises.
    """
    try:
        action()
        return
    except Infeasible as problem:
        if problem.reason not in LOST or robot.recovering:
            raise
        if not robot.may_recover:
            raise Infeasible("recovered", f"a second try is due: {problem.detail}") from problem
        lost = problem
    robot.recovering = True
    robot.hands.care = CARE
    for side in SIDES:
        if _lost(robot, side):
            arm = robot.arm(side)
            robot.do(arm.open())
            robot.tried(lambda arm=arm: robot.do(arm.retreat(BACK_OFF)))
            robot.do(arm.wait(CALM))
    try:
        action()
    except Infeasible as problem:
        # Where it fell it may be out of reach: that is no failure of planning.
        raise lost if problem.reason in PLANNING else problem from None


def _lost(robot: "ExpertRobot", side: str) -> bool:
    """What the hand held is gone, or it has just closed on nothing."""
    held = robot.holding.get(side)
    if held is None:
        return robot.world.robot.arm(side).gripper < CLOSED
    return not robot.scene.touching(f"{side}_gripper", held)
