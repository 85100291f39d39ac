"""A bowl or a cup that is held by its rim: one finger inside, one outside."""

from rtphys.task import Arm, Robot

OUTER = {"left": (2, 3), "right": (0, 1)}  # contact points of the rim on the arm's own side
HALF_OPEN = 0.5  # share of the opening: the inner finger stays clear of the far wall
OPENING_TIME = 0.4  # [s] that damped fingers may need to open


def release_rim(robot: Robot, arm: Arm, rise: float) -> None:
    """Open half, rise by `rise` [m] out of the container, then open wholly."""
    robot.do(arm.open(HALF_OPEN))
    robot.do(arm.lift(rise))
    robot.do(arm.open())
    robot.do(arm.wait(OPENING_TIME))
