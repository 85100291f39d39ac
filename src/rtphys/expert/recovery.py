"""One second try when a hand has lost what it took: let go, back off, take it again."""

from collections.abc import Callable

from rtphys.assets.action_layout import SIDES
from rtphys.core.errors import Infeasible
from rtphys.expert.hands import Hands
from rtphys.task.arm import Robot

LOST = frozenset({"slipped", "grasp_missed"})  # reasons that a second try may cure
BACK_OFF = 0.08  # [m] the way a hand came in to grasp
CALM = 0.4  # [s] for what was dropped to come to rest
PLANNING = frozenset({"unreachable", "no_path", "retime_failed", "ungraspable"})
CARE = 0.6  # share of the first pace with which a load is carried that slipped once


class Recovery:
    """Whether an attempt may try once more to take hold of a load, and whether it has."""

    def __init__(self, hands: Hands, allowed: bool = True) -> None:
        """
        Args:
            allowed: false ends the attempt ("recovered") where a second try is due.
        """
        self._hands, self._allowed = hands, allowed
        self.begun = False

    def retake(self, robot: Robot, action: Callable[[], None]) -> None:
        """Run `action`; once in an episode, run it again when its load was lost.

        Raises:
            Infeasible: "recovered", when a second try is due but not allowed; else what the
                action, or its second try, raises.
        """
        try:
            action()
            return
        except Infeasible as problem:
            if problem.reason not in LOST or self.begun:
                raise
            if not self._allowed:
                raise Infeasible("recovered", f"a second try is due: {problem.detail}") from problem
            loss = problem
        self.begun = True
        self._hands.care = CARE
        for side in SIDES:
            if self._hands.lost(side):
                arm = robot.arm(side)
                robot.do(arm.open())
                robot.tried(lambda arm=arm: robot.do(arm.retreat(BACK_OFF)))
                robot.do(arm.wait(CALM))
        try:
            action()
        except Infeasible as problem:
            # Where it fell it may be out of reach: that is no failure of planning.
            raise loss if problem.reason in PLANNING else problem from None
