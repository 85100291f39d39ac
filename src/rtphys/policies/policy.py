"""Interface of policies: an object that plays one episode to its end."""

import traceback
from abc import ABC, abstractmethod
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Protocol

import numpy as np

from rtphys.assets.embodiment import DEFAULT
from rtphys.core.bounds import LONGEST_REPORT
from rtphys.core.errors import RtphysError
from rtphys.core.poses import Array
from rtphys.data.json_text import spelled
from rtphys.episode import Observation, PolicyEpisode
from rtphys.episode.control import ActionKind


class PolicyGone(RtphysError):
    """A policy cannot be reached at all, so the episode has no result.

    It stops an evaluation, which can be resumed. Any other error that a policy raises counts as
    failure of the episode that it was playing.
    """

    exit_code = 5

    def __init__(self, policy: str, problem: str) -> None:
        super().__init__(f"policy {policy}: {problem}")


class ServerFailed(RtphysError):
    """A server reports an error of its own, which counts as failure of the episode."""


class PolicyBroken(RtphysError):
    """A policy raises where it is "opened" or "closed", which stops an evaluation as well."""

    exit_code = 5

    def __init__(self, policy: str, doing: str, error: BaseException) -> None:
        frames = traceback.extract_tb(error.__traceback__)
        place = f" ({Path(frames[-1].filename).name}, line {frames[-1].lineno})" if frames else ""
        super().__init__(f"policy {policy} cannot be {doing}: {one_line(error)}{place}")


def one_line(error: BaseException) -> str:
    """What an error says, even one whose own `__str__` raises."""
    text = " ".join("".join(traceback.format_exception_only(error)).split())
    return spelled(text[:LONGEST_REPORT])


@dataclass(frozen=True)
class PolicySetup:
    """Facts that a policy may need before its first episode. Picklable.

    A process opens a policy again whenever the setup changes, that is for every task.
    """

    task: str = ""
    protocol: str = "clean"
    split: str = "unseen"  # of the sentences: "seen" or "unseen"
    seed: int = 0  # for the policy's own random numbers, not an episode's seed
    options: Mapping[str, str] = field(default_factory=dict)  # given by the user, by key
    embodiment: str = DEFAULT
    arm_joints: tuple[int, int] = (6, 6)  # of the left and of the right arm


class Policy(Protocol):
    """Plays one episode after the other in a worker process.

    To be reproducible, it must keep no state between episodes and derive all random numbers from
    `episode.seed`: which episodes a worker gets depends on the number of workers.
    """

    needs_images: bool
    """Whether it needs pictures; if so, a missing renderer is reported before any episode."""

    def play(self, episode: PolicyEpisode) -> None:
        """Act until `episode.over`; returning earlier means giving up."""
        ...

    def close(self) -> None:
        """Release models and connections."""
        ...


class Stepwise(ABC):
    """Base class of policies that map an observation to one or several actions; define `act`."""

    needs_images = True
    kind: ActionKind = "qpos"
    """What `act` returns: see `PolicyEpisode.act`."""

    def reset(self, episode: PolicyEpisode) -> None:  # noqa: B027 - an empty hook on purpose
        """Called before the first observation; `episode.instruction` is the sentence to follow."""

    @abstractmethod
    def act(self, observation: Observation) -> Array | None:
        """The next actions (k, N) or one action (N,), k >= 1: absolute targets and openings.

        None gives up: the episode is judged as it is.
        """

    def play(self, episode: PolicyEpisode) -> None:
        self.reset(episode)
        while not episode.over and (actions := self.act(episode.observe())) is not None:
            if not len(chunk := np.atleast_2d(actions)):  # it would be asked for ever
                raise ValueError("act returned no action; it returns None to give up")
            for action in chunk:
                episode.act(action, self.kind)

    def close(self) -> None:  # noqa: B027 - an empty hook on purpose
        """Nothing to release."""


def action_rows(actions: object, size: int, where: str) -> Array:
    """Actions (n, size), n >= 1, from a server's answer; a single action may come as (size,).

    Raises `ServerFailed`: it has another shape, or holds no numbers or some that are not finite.
    """
    try:
        array = np.atleast_2d(np.array(actions, float))
    except (TypeError, ValueError) as error:
        raise ServerFailed(f"{where}: actions are no numbers: {error}") from error
    if array.ndim != 2 or array.shape[1] != size or len(array) == 0:
        raise ServerFailed(f"{where}: answered actions of shape {array.shape}, not (n, {size})")
    if not np.isfinite(array).all():
        row = int(np.flatnonzero(~np.isfinite(array).all(axis=1))[0])
        numbers = array[row].tolist()  # an array would be shown on several lines
        raise ServerFailed(f"{where}: action {row} of {len(array)} is not finite: {numbers}")
    return array
