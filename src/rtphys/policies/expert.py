"""The scripted expert as a policy: the reference that solves every certified instance."""

from contextlib import suppress

from rtphys.core.errors import Infeasible
from rtphys.core.seeds import stream
from rtphys.episode import PolicyEpisode
from rtphys.expert.robot import ExpertRobot
from rtphys.policies.policy import PolicySetup
from rtphys.sim.recorder import FRAME_STEPS


class Expert:
    """Runs the task's script to its end, as a demonstration does.

    It knows the whole world and speaks to the servos at 250 Hz, so it is no policy to compare
    with, but a proof that the instance can be solved. Each frame counts as one action.
    """

    needs_images = False

    def play(self, episode: PolicyEpisode) -> None:
        rollout, outcome = episode.rollout, None
        robot = ExpertRobot(rollout, stream(episode.seed, "expert"))
        with suppress(Infeasible):  # then the instance was certified under something else
            episode.instance.task.script(robot)
            outcome = rollout.finish()
        episode.conclude(rollout.steps // FRAME_STEPS, outcome)

    def close(self) -> None:
        """Nothing to let go of."""


def open_expert(argument: str, setup: PolicySetup) -> Expert:
    """`expert`."""
    return Expert()
