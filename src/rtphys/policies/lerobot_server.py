"""Runs a LeRobot checkpoint for `rtphys.policies.lerobot`, in a Python that has lerobot.

`python lerobot_server.py SOCKET` gets the number of an open socket. It needs lerobot >= 0.4 and
what that brings, and nothing of rtphys. Every message is a .npz: arrays by name, and `about`, JSON.
"""

# pyright: reportMissingImports=false

import io
import json
import os
import pkgutil
import random
import sys
import traceback
from importlib import import_module, metadata
from multiprocessing.connection import Connection
from typing import Any

import numpy as np

Message = tuple[dict[str, Any], dict[str, np.ndarray]]  # about, arrays

STATE = "observation.state"
PLUGINS = "lerobot_policy_"  # beginning of the names of packages that bring policies to LeRobot


def pack(about: dict[str, Any], arrays: dict[str, np.ndarray] | None = None) -> bytes:
    """A message as bytes."""
    buffer = io.BytesIO()
    text = {"about": np.array(json.dumps(about))}
    np.savez(buffer, allow_pickle=False, **text, **(arrays or {}))
    return buffer.getvalue()


def unpack(raw: bytes) -> Message:
    """Inverse of `pack`. Raises ValueError, KeyError, OSError or EOFError for other bytes."""
    with np.load(io.BytesIO(raw), allow_pickle=False) as found:
        arrays = dict(found)
    return json.loads(str(arrays.pop("about"))), arrays


class Checkpoint:
    """A checkpoint as lerobot runs it: processors, queues of actions and all.

    Args:
        path: folder or name on the Hub.
        device: "cpu", "cuda" ...; empty: the checkpoint's own.
        execute: actions of a chunk to carry out; 0: as the checkpoint says.
    """

    def __init__(self, path: str, device: str, execute: int) -> None:
        configs = import_module("lerobot.configs.policies")
        factory = import_module("lerobot.policies.factory")
        self.torch = import_module("torch")
        for found in pkgutil.iter_modules():
            if found.name.startswith(PLUGINS):
                try:
                    import_module(found.name)  # it registers itself
                except Exception as error:  # LeRobot skips it too: it may not be wanted
                    print(f"{found.name}: {last_line(error)}", file=sys.stderr)
        config = configs.PreTrainedConfig.from_pretrained(path)
        config.device = device or config.device
        if execute:
            check_execute(config, execute)
            config.n_action_steps = execute
        self.policy = factory.get_policy_class(config.type).from_pretrained(path, config=config)
        self.config, on = self.policy.config, {"device": config.device}
        self.before, self.after = factory.make_pre_post_processors(
            self.config,
            pretrained_path=path,
            preprocessor_overrides={"device_processor": on},
            postprocessor_overrides={"device_processor": {"device": "cpu"}},
        )

    def about(self) -> dict[str, Any]:
        """What the other side checks before the first episode.

        `chunk`: actions that one observation may fill a queue with. Policies that look at several
        instants, or weigh several chunks, need an observation for each action.
        """
        inputs = {name: list(one.shape) for name, one in self.config.input_features.items()}
        outputs = {name: list(one.shape) for name, one in self.config.output_features.items()}
        one = getattr(self.config, "n_obs_steps", 1) == 1
        ensemble = getattr(self.config, "temporal_ensemble_coeff", None) is not None
        chunk = getattr(self.config, "n_action_steps", 1) if one and not ensemble else 1
        return {"inputs": inputs, "outputs": outputs, "chunk": chunk}

    def reset(self, seed: int) -> None:
        """Begin an episode; all chance in it follows from the seed."""
        random.seed(seed)
        np.random.seed(seed % 2**32)  # noqa: NPY002  # what other people's policies draw from
        self.torch.manual_seed(seed)
        for part in (self.policy, self.before, self.after):
            part.reset()

    def act(self, arrays: dict[str, np.ndarray], sentence: str, count: int) -> np.ndarray:
        """The next actions (count, n), all for this observation."""
        batch: dict[str, Any] = {"task": sentence, "robot_type": ""}
        with self.torch.inference_mode():
            for name, array in arrays.items():
                tensor = self.torch.from_numpy(array)
                if tensor.ndim == 3:  # a picture (H, W, 3), 0..255
                    tensor = (tensor.float() / 255).permute(2, 0, 1).contiguous()
                batch[name] = tensor[None].to(self.config.device)
            batch = self.before(batch)
            actions = [self.after(self.policy.select_action(batch)) for _ in range(count)]
        return self.torch.cat(actions).float().numpy()


def check_execute(config: Any, count: int) -> None:
    """Raises ValueError: a chunk has fewer actions, which lerobot checks where it reads a file."""
    ensemble = getattr(config, "temporal_ensemble_coeff", None) is not None
    most = 1 if ensemble else getattr(config, "chunk_size", count)
    if count > most:
        why = "with temporal ensembling" if ensemble else "of a chunk"
        raise ValueError(f"execute = {count} is not allowed; at most {most} {why}")


def serve(connection: Connection) -> None:
    """Answer until the other side closes the connection."""
    checkpoint = None
    while True:
        try:
            about, arrays = unpack(connection.recv_bytes())
        except EOFError:
            return
        answer: dict[str, Any] = {}
        found: dict[str, np.ndarray] = {}
        try:
            if about["do"] == "open":
                import_module("torch").set_num_threads(about["threads"])
                checkpoint = Checkpoint(about["path"], about["device"], about["execute"])
                answer = checkpoint.about()
            elif checkpoint is None:
                raise RuntimeError("no checkpoint is open")
            elif about["do"] == "reset":
                checkpoint.reset(about["seed"])
            else:
                found = {"actions": checkpoint.act(arrays, about["task"], about["count"])}
        except Exception as error:  # the other side reports it
            missing = error.name if isinstance(error, ImportError) else None
            answer = {"error": last_line(error), "missing": missing}
            answer |= {"trace": traceback.format_exc(), "lerobot": lerobot_version()}
        connection.send_bytes(pack(answer, found))


def lerobot_version() -> str:
    """Version of the lerobot that is installed here; empty where there is none."""
    try:
        return metadata.version("lerobot")
    except metadata.PackageNotFoundError:
        return ""


def last_line(error: Exception) -> str:
    """An error in one line."""
    return " ".join("".join(traceback.format_exception_only(error)).split())


if __name__ == "__main__":
    os.dup2(2, 1)  # what lerobot prints is no message
    del sys.path[0]  # this folder: its names must not hide those of packages
    serve(Connection(int(sys.argv[1])))
