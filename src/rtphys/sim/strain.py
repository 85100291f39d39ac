"""What a robot suffers: forces on its links other than fingers, and torques of its arm joints."""

from dataclasses import dataclass

import numpy as np

from rtphys.core.poses import Array
from rtphys.sim.engine import TIME_STEP
from rtphys.sim.world import World

STRIDE = 10  # [steps] between two looks: 40 ms
MAX_FORCE = 30.0  # [N] on a link that is no finger
MAX_SECONDS = 0.1  # [s] for which a link may be pressed harder, or a motor be at its limit
AT_LIMIT = 0.99  # share of a motor's largest torque
NONE = np.zeros(3)  # [N s]


@dataclass
class Strain:
    """The largest loads on a robot in one episode so far."""

    force: float = 0.0  # [N] on one link that is no finger
    pair: str = ""  # that link and what it met, as "left_camera and cabinet"
    force_seconds: float = 0.0  # [s] longest time above MAX_FORCE
    torque: float = 0.0  # of an arm joint, as a share of its motor's largest
    joint: str = ""  # that joint
    torque_seconds: float = 0.0  # [s] longest time at the limit

    @property
    def problem(self) -> tuple[str, str] | None:
        """Why no real robot should do this, as a reason and its detail; None if it may."""
        if self.force_seconds > MAX_SECONDS:
            seconds = f"over {MAX_FORCE:g} N for {self.force_seconds:.2f} s"
            return "collision", f"{self.pair} press with {self.force:.0f} N, {seconds}"
        if self.torque_seconds > MAX_SECONDS:
            seconds = f"for {self.torque_seconds:.2f} s"
            return "overloaded", f"{self.joint} gives its largest torque {seconds}"
        return None


class StrainMonitor:
    """Looks at the contacts and joints of one robot every STRIDE steps."""

    def __init__(self, world: World) -> None:
        robot = self._robot = world.robot
        fingers = {link for arm in robot.arms for link in arm.finger_links}
        # Keyed by the component itself: held here, it is the same object in every contact.
        links = [link for link in robot.articulation.links if link not in fingers]
        self._links: dict[object, str] = {link: link.name for link in links}
        self._index = np.concatenate([arm.index for arm in robot.arms])
        self._limits = np.concatenate([arm.limb.effort for arm in robot.arms])
        self._world = world
        self._pressed = self._at_limit = 0  # looks in a row
        self.strain = Strain()

    def tick(self, step: int) -> None:
        """After every physics step."""
        if step % STRIDE:
            return
        strain = self.strain
        force, pair = max(self._pairs(), default=(0.0, ""))
        if force > strain.force:
            strain.force, strain.pair = force, pair
        self._pressed = self._pressed + 1 if force > MAX_FORCE else 0
        strain.force_seconds = max(strain.force_seconds, self._pressed * STRIDE * TIME_STEP)
        shares = np.abs(self._robot.effort()[self._index]) / self._limits
        torque = float(shares.max())
        if torque > strain.torque:
            joint = self._robot.articulation.active_joints[self._index[int(shares.argmax())]]
            strain.torque, strain.joint = torque, joint.name
        self._at_limit = self._at_limit + 1 if torque > AT_LIMIT else 0
        strain.torque_seconds = max(strain.torque_seconds, self._at_limit * STRIDE * TIME_STEP)

    def _pairs(self) -> list[tuple[float, str]]:
        """Forces [N] that act on links now, and between what."""
        impulses = dict[tuple[str, str], Array]()
        for contact in self._world.solver.get_contacts():
            first, second = contact.bodies
            link, other = (first, second) if first in self._links else (second, first)
            if link not in self._links:
                continue
            for point in contact.points:
                if any(point.impulse.tolist()):
                    key = self._links[link], self._links.get(other) or other.entity.name
                    impulses[key] = impulses.get(key, NONE) + point.impulse
        return [
            (float(np.linalg.norm(impulse)) / TIME_STEP, f"{link} and {other}")
            for (link, other), impulse in impulses.items()
        ]
