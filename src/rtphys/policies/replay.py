"""The recorded actions of a dataset's episodes, open loop: the baseline that never looks."""

from pathlib import Path

from rtphys.core.errors import BadFile, BadValue, UnknownName
from rtphys.data.dataset import Dataset
from rtphys.data.dataset import Episode as Stored
from rtphys.episode import PolicyEpisode
from rtphys.policies.policy import PolicyGone, PolicySetup


class Replay:
    """Plays what was recorded of the same task and seed.

    A dataset of another protocol will do if it is the only one: `replay:CLEAN` under `phys_random`
    asks how far clean actions carry under physics that they know nothing of.

    Raises:
        BadFile: no dataset there.
        UnknownName, BadValue: it has nothing of this task, or several protocols but not this one.
    """

    needs_images = False

    def __init__(self, folder: Path, task: str, protocol: str) -> None:
        data = Dataset(folder).where(task=task)
        protocols = data.protocols
        if protocol in protocols:
            data = data.where(protocol=protocol)
        elif len(protocols) > 1:
            raise UnknownName("protocol", protocol, protocols, folder)
        self._folder = folder
        self._stored: dict[int, Stored] = {episode.seed: episode for episode in data}

    def play(self, episode: PolicyEpisode) -> None:
        if episode.seed not in self._stored:
            told = f"{self._folder} holds no episode of {episode.task}, seed {episode.seed}"
            cure = f"collect that seed, or give `instances` {self._folder}"
            raise PolicyGone("replay", f"{told}; {cure}")
        for action in self._stored[episode.seed].action:
            if episode.over:
                return
            episode.act(action)

    def close(self) -> None:
        """Nothing to let go of."""


def open_replay(argument: str, setup: PolicySetup) -> Replay:
    """`replay:DATASET`."""
    if not argument:
        raise BadValue("policy", "replay:", "name a dataset's folder: replay:DATASET")
    folder = Path(argument)
    if not folder.exists():
        raise BadFile(folder, "there is no such dataset")
    return Replay(folder, setup.task, setup.protocol)
