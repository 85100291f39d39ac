"""Lids and doors that a hand swings open: how far they are open, and how far they have to go."""

from rtphys.task import Arm, Robot, Scene

PAUSE = 0.24  # [s] between two looks at a hinge


def share_open(scene: Scene, prop: str) -> float:
    """How far the hinge is open, as a share of its range."""
    q, low, high = scene.joint(prop)
    return (q - low) / (high - low)


def angle_to(scene: Scene, prop: str, share: float) -> float:
    """Angle [rad] from where the hinge is to a share of its range."""
    q, low, high = scene.joint(prop)
    return low + share * (high - low) - q


def opened_in_time(robot: Robot, arm: Arm, prop: str, share: float, pauses: int) -> bool:
    """Whether the hinge gets past a share of its range while the arm keeps still.

    A stiff hinge follows the hand late.

    Args:
        pauses: looks at the hinge, at most.
    """
    for _ in range(pauses):
        if share_open(robot.scene, prop) > share:
            return True
        robot.do(arm.wait(PAUSE))
    return False
