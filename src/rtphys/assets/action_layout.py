"""Where the commands of both arms stand in one vector."""

from dataclasses import dataclass

SIDES: tuple[str, str] = ("left", "right")


@dataclass(frozen=True)
class ActionLayout:
    """Left arm, left gripper, right arm, right gripper: joint targets [rad], openings 0..1.

    The same order holds for measured positions, and for ee poses in the place of joints. Indices
    of the two arms come as (left, right).
    """

    numbers_per_arm: int  # its joints, or the 7 of a pose

    @property
    def size(self) -> int:
        """How many numbers command both arms."""
        return 2 * self._width

    @property
    def _width(self) -> int:
        return self.numbers_per_arm + 1

    @property
    def arms(self) -> tuple[slice, slice]:
        """Where the joints of each arm are."""
        n = self.numbers_per_arm
        return slice(0, n), slice(self._width, self._width + n)

    @property
    def grippers(self) -> tuple[int, int]:
        """Where the opening of each gripper is."""
        return self.numbers_per_arm, self._width + self.numbers_per_arm

    @property
    def sides(self) -> tuple[slice, slice]:
        """Where each arm with its gripper is."""
        return slice(0, self._width), slice(self._width, self.size)

    @property
    def joints_alone(self) -> tuple[slice, slice]:
        """Where the joints of each arm are in a vector without the grippers."""
        n = self.numbers_per_arm
        return slice(0, n), slice(n, 2 * n)

    @property
    def names(self) -> tuple[str, ...]:
        """left_joint_1 and so on, left_gripper, then the same of the right arm."""
        parts = [*(f"joint_{k}" for k in range(1, self._width)), "gripper"]
        return tuple(f"{side}_{part}" for side in SIDES for part in parts)

    def __str__(self) -> str:
        n = self.numbers_per_arm
        return f"left arm {n} [rad], left gripper 0..1, right arm {n}, right gripper"
