"""The trained network as a policy: --policy python:examples/visual_policy/visual_policy.py:load

`--policy-option weights=PATH` names the checkpoint, or the folder of checkpoints `<task>.pt`.
`execute` (8) is how many of a chunk's actions are carried out, `device` where the network computes,
`patience` (2) after how many times the longest demonstration the policy gives up.
"""

from pathlib import Path

import numpy as np
import torch
from network import Network, Shape
from numpy.typing import NDArray
from pretrained import Eye
from sight import felt, looks, shrunk

from rtphys.episode import Observation, PolicyEpisode
from rtphys.policies import PolicySetup


class VisualPolicy:
    """Acts on three small pictures, the command, and what is felt if it was trained with it."""

    needs_images = True

    def __init__(self, checkpoint: Path, options: dict[str, str]) -> None:
        torch.set_num_threads(1)  # the evaluation has a process for each core
        self._device = options.get("device", "cpu")
        self._execute = int(options.get("execute", 8))
        found = torch.load(checkpoint, map_location=self._device, weights_only=True)
        self._eye = Eye(self._device)
        self._net = Network(Shape(**found["shape"])).to(self._device).eval()
        self._net.load_state_dict(found["net"])
        self._looks = looks(found["options"]["sees"]).tolist()
        self._felt = list[NDArray[np.float32]]()  # before each action of this episode
        self._most = int(float(options.get("patience", 2)) * found["longest"])

    def play(self, episode: PolicyEpisode) -> None:
        """Act until the episode is over, or for as long as demonstrations make sense."""
        self._felt.clear()
        while not episode.over and episode.taken < self._most:
            for action in self._chunk(episode.observe()):
                self._felt.append(self._feel(episode.observe()))
                episode.act(action)

    def close(self) -> None:
        """Nothing to release."""

    def _feel(self, observation: Observation) -> NDArray[np.float32]:
        return felt(observation) if self._net.shape.felt else np.empty(0, np.float32)

    @torch.no_grad()
    def _chunk(self, observation: Observation) -> NDArray[np.float64]:
        seen = {
            camera: tuple(
                torch.from_numpy(array).to(self._device) for array in self._eye(picture[None])
            )
            for camera, picture in shrunk(observation.images).items()
        }
        command = self._tensor(observation.vector.astype(np.float32))
        before = [*self._felt, self._feel(observation)]
        shown = [before[max(0, len(before) - 1 - ago)] for ago in self._looks]
        remembered = self._tensor(np.array(shown))
        actions, _ = self._net(seen, command, remembered)
        return actions[0, : self._execute].double().cpu().numpy()

    def _tensor(self, array: np.ndarray) -> torch.Tensor:
        return torch.from_numpy(np.ascontiguousarray(array))[None].to(self._device)


def load(setup: PolicySetup) -> VisualPolicy:
    """Load the network of the setup's task."""
    weights = Path(setup.options["weights"])
    checkpoint = weights / f"{setup.task}.pt" if weights.is_dir() else weights
    return VisualPolicy(checkpoint, dict(setup.options))
