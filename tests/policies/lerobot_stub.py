"""The real server with a made-up checkpoint, whose name says what it does; needs no lerobot."""

import os
import sys
from multiprocessing.connection import Connection
from pathlib import Path
from types import SimpleNamespace
from typing import Any

sys.path.insert(0, str(Path(sys.argv[1]).parent))

import lerobot_server
import numpy as np

SHAPES = {"observation.state": [14], "observation.images.cam_high": [3, 240, 320]}
CHANGED = {
    "other_robot": {"observation.state": [6]},
    "other_cameras": {"observation.images.top": [3, 240, 320]},
    "knows_physics": {"observation.environment_state": [15]},
    "knows_other_physics": {"observation.environment_state": [13]},
    "larger": {"observation.images.cam_high": [3, 480, 640]},
}


class Checkpoint:
    """Moves the first joint by 0.01 rad each action, for three actions at a time."""

    def __init__(self, path: str, device: str, execute: int) -> None:
        if path == "no_lerobot":
            raise ModuleNotFoundError("No module named 'lerobot'", name="lerobot.policies")
        if path == "damaged":
            raise ValueError("the header of\nmodel.safetensors is too large")
        self.path, self.chunk = path, execute or 3

    def about(self) -> dict[str, Any]:
        inputs = SHAPES | CHANGED.get(self.path, {})
        return {"inputs": inputs, "outputs": {"action": [14]}, "chunk": self.chunk}

    def reset(self, seed: int) -> None:
        self.seed = seed

    def act(self, arrays: dict[str, np.ndarray], sentence: str, count: int) -> np.ndarray:
        if self.path == "dies":
            print("out of memory", file=sys.stderr, flush=True)
            os._exit(3)
        if self.path == "talks":
            return np.zeros((2**21, 14), np.float32)
        if self.path == "fails":
            raise RuntimeError(f"cannot {sentence[:0]}multiply")
        print("a library talks on standard output")
        assert arrays["observation.images.cam_high"].shape == (240, 320, 3)
        actions = np.tile(arrays["observation.state"], (count, 1))
        actions[:, 0] += 0.01 * np.arange(1, count + 1)
        if self.path == "knows_physics":
            actions[:, 1] += arrays["observation.environment_state"][7]  # friction
        if self.path == "nan":
            actions[-1, 4] = np.nan
        return actions


lerobot_server.lerobot_version = lambda: "0.3.9"  # type: ignore[assignment]
sys.modules["torch"] = SimpleNamespace(set_num_threads=lambda n: None)  # type: ignore[assignment]
lerobot_server.Checkpoint = Checkpoint  # type: ignore[misc]
lerobot_server.serve(Connection(int(sys.argv[2])))
