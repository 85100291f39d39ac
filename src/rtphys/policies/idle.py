"""A robot that does nothing. A task that it solves is no task."""

from rtphys.core.poses import Array
from rtphys.episode import Observation
from rtphys.policies.policy import PolicySetup, Stepwise


class Idle(Stepwise):
    """Repeats the command that is in force."""

    needs_images = False

    def act(self, observation: Observation) -> Array:
        return observation.vector


def open_idle(argument: str, setup: PolicySetup) -> Idle:
    """`idle`."""
    return Idle()
