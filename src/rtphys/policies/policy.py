"""What a policy is: something that plays one episode to its end."""

from abc import ABC, abstractmethod
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Protocol

import numpy as np

from rtphys.core.errors import RtphysError
from rtphys.core.poses import Array
from rtphys.episode import Observation, PolicyEpisode


class PolicyGone(RtphysError):
    """A policy cannot be reached at all: nothing that could be called a result.

    It stops an evaluation, which can be resumed. Anything else that a policy raises is a failure
    of the episode that it was playing.
    """

    exit_code = 5

    def __init__(self, policy: str, problem: str) -> None:
        super().__init__(f"policy {policy}: {problem}")


@dataclass(frozen=True)
class PolicySetup:
    """What a policy may want to know before its first episode. Picklable.

    A policy is opened anew in a process whenever its setup changes, that is for every task.
    """

    task: str = ""
    protocol: str = "clean"
    split: str = "unseen"  # of the sentences, and of the pictures on table and wall
    seed: int = 0  # of the policy's own chance, not of an episode
    options: Mapping[str, str] = field(default_factory=dict)  # `--set key=value`


class Policy(Protocol):
    """Lives in a worker process, plays one episode after the other.

    To be reproducible it must remember nothing from one episode to the next, and draw all chance
    from `episode.seed`: which episodes a worker gets depends on the number of workers.
    """

    needs_images: bool
    """Whether it will ask for pictures; then a missing renderer is told before any episode."""

    def play(self, episode: PolicyEpisode) -> None:
        """Acts until `episode.over`, or gives up by returning before."""
        ...

    def close(self) -> None:
        """Lets go of models and connections."""
        ...


class Stepwise(ABC):
    """A policy that maps an observation to a chunk of actions; derive, and write `act`."""

    needs_images = True

    def reset(self, episode: PolicyEpisode) -> None:  # noqa: B027 - an empty hook on purpose
        """Called before the first observation of an episode; the instruction is the episode's."""

    @abstractmethod
    def act(self, observation: Observation) -> Array:
        """The next actions (k, N) or one action (N,), absolute joint targets, openings; k >= 1."""

    def play(self, episode: PolicyEpisode) -> None:
        """Observes, acts out the whole chunk, and so on."""
        self.reset(episode)
        while not episode.over:
            for action in np.atleast_2d(self.act(episode.observe())):
                episode.act(action)

    def close(self) -> None:  # noqa: B027 - an empty hook on purpose
        """Nothing to let go of."""
