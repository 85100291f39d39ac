"""What success conditions and scripts may see: measured quantities, in the task frame."""

from typing import Protocol

from rtphys.core.poses import Array, Pose
from rtphys.physics.values import Physics

LEFT, RIGHT = "left", "right"


class Scene(Protocol):
    """A measured view of the running world. Prop names are the task's own.

    Surfaces that are no props: "table", "left_gripper", "right_gripper", "left_arm", "right_arm".
    """

    @property
    def physics(self) -> Physics:
        """The physics in force in this episode; for a script, what its robot takes it to be."""
        ...

    @property
    def time(self) -> float:
        """[s] since the policy stage began."""
        ...

    def pose(self, prop: str, link: str = "") -> Pose:
        """Frame of a prop (or of a link of an articulated one), task frame."""
        ...

    def start(self, prop: str) -> Pose:
        """Its frame when the policy stage began, after settling."""
        ...

    def functional(self, prop: str, index: int = 0) -> Pose:
        """Functional point frame, task frame."""
        ...

    def contact(self, prop: str, index: int = 0) -> Pose:
        """Contact point frame (+y outward), task frame."""
        ...

    def speed(self, prop: str) -> float:
        """Speed of the prop's centre of mass over the last 20 ms or a little more [m/s]."""
        ...

    def lowest(self, prop: str) -> float:
        """Height of the prop's lowest collision vertex, task frame [m]."""
        ...

    def on_top(self, prop: str) -> Pose:
        """Where a thing may be put down on this prop: above the middle of what it covers, z up.

        The height is that of its highest collision vertex; the axes are the task frame's.
        """
        ...

    def opening(self, side: str) -> float:
        """Measured gripper opening, 0 closed .. 1 open, from joint positions."""
        ...

    def tcp(self, side: str) -> Pose:
        """Tool centre point, task frame."""
        ...

    def touching(self, a: str, b: str) -> bool:
        """Whether two props or surfaces press on each other (contact impulse > 0)."""
        ...

    def contact_points(self, a: str, b: str) -> Array:
        """Points of contact between the two, (n, 3), task frame."""
        ...

    def impulse(self, a: str, b: str) -> float:
        """Sum of contact impulse magnitudes between the two in this step [N s]."""
        ...

    def joint(self, prop: str, index: int = 0) -> tuple[float, float, float]:
        """Position, lower and upper limit of an articulated prop's joint [rad or m]."""
        ...

    def once(self, name: str, now: bool) -> bool:
        """Latches: true from the first instant `now` was true in this episode."""
        ...

    def peak(self, name: str, now: float) -> float:
        """Largest value given under this name so far in this episode."""
        ...
