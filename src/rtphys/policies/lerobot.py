"""A LeRobot checkpoint in a Python of its own: `lerobot:PATH?python=/venv/bin/python`.

lerobot's versions of torch and NumPy need not be ours, so its process shares nothing with this one
but a socket (`lerobot_server`).
"""

import contextlib
import os
import subprocess
import sys
import tempfile
from collections.abc import Mapping
from multiprocessing import Pipe
from pathlib import Path
from typing import Literal

import numpy as np

from rtphys.core.bounds import LARGEST_MESSAGE, LONGEST_REPORT
from rtphys.core.errors import BadFile, BadValue, UnknownName
from rtphys.data.episode import CAMERA_NAMES
from rtphys.episode import Observation, PolicyEpisode
from rtphys.physics import Physics
from rtphys.physics.attribute import is_attribute
from rtphys.physics.values import components
from rtphys.policies import lerobot_server
from rtphys.policies.lerobot_server import STATE
from rtphys.policies.policy import PolicyGone, PolicySetup, ServerFailed, action_rows
from rtphys.policies.registry import CHECKPOINTS, Seconds, split_options
from rtphys.spec import recording
from rtphys.spec.episode import EpisodeSpec
from rtphys.spec.option import Positive, checked_dataclass, from_words

EE_POSE = "observation.ee_pose"
PHYSICS = "observation.environment_state"  # as ACT and Diffusion read it
PICTURE = "observation.images."
# Our cameras -> their names in an export, by either naming, and their own.
CAMERAS = {
    name: (*(naming[recording.CAMERAS[name]] for naming in CAMERA_NAMES.values()), name)
    for name in recording.USUAL
}
FAREWELL = 5.0  # [s] that the process has to end
OURS = ("PYTHONPATH", "PYTHONHOME", "PYTHONSTARTUP")  # variables that are meant for this Python


@checked_dataclass(frozen=True)
class LeRobotOptions:
    """How a checkpoint runs."""

    python: str = sys.executable
    device: str = ""  # empty: the checkpoint's own
    execute: Positive | None = None  # actions of a chunk to carry out; None: as it says itself
    observe: Literal["action", "chunk"] = "action"  # what gets a new observation; LeRobot's: action
    cameras: str = ""  # `head=top,left=wrist`: names in the checkpoint, where they are not ours
    threads: Positive = 1  # of torch, on a CPU
    physics: bool = False  # show the labels too: an oracle, which knows what no robot senses
    reply_s: Seconds = 600.0  # limit for one answer


class LeRobot:
    """Policy in a process of its own; `path` is a folder, or a name on the Hub.

    Raises `PolicyGone`: that Python does not start, lacks lerobot, or cannot open the checkpoint;
    `BadValue`, `UnknownName`: the checkpoint is another robot's, or wants what no policy sees.
    """

    needs_images = True

    def __init__(self, path: str, given: LeRobotOptions, setup: PolicySetup) -> None:
        self._name, self._given, self._seed = f"lerobot:{path}", given, setup.seed
        self._stderr = tempfile.TemporaryFile()  # noqa: SIM115 - closed in `close`
        self._start()
        try:
            asked = {"device": given.device, "execute": given.execute, "threads": given.threads}
            about, _ = self._ask({"do": "open", "path": path, **asked})
            if "error" in about:
                version, missing = about.get("lerobot"), about.get("missing") or ""
                if missing.partition(".")[0] in ("torch", "lerobot"):
                    there = f"lerobot {version} and " if version else ""
                    problem = f"has {there}no {missing} (lerobot >= 0.4 is needed)"
                    cure = "name a Python that has it: lerobot:PATH?python=/venv/bin/python"
                    raise PolicyGone(self._name, f"{given.python} {problem}; {cure}")
                by = f" by lerobot {version}" if version else ""
                problem = f"cannot be opened{by}: {about['error'][:LONGEST_REPORT]}"
                raise PolicyGone(self._name, problem)
            self._pictures = pictures(about["inputs"], given.cameras)
            drawn = EpisodeSpec(setup.task, setup.protocol).draw(0) if setup.task else None
            check_vectors(about, sum(setup.arm_joints) + 2, given.physics, drawn)
            self._inputs = about["inputs"]
            self._count = about["chunk"] if given.observe == "chunk" else 1
        except BaseException:
            self.close()
            raise

    def _start(self) -> None:
        python, environment = self._given.python, dict(os.environ)
        if python != sys.executable:  # it would find our packages, built for another Python
            environment = {key: v for key, v in environment.items() if key not in OURS}
        self._connection, theirs = Pipe()
        with theirs:
            try:
                self._process = subprocess.Popen(
                    [python, lerobot_server.__file__, str(theirs.fileno())],
                    stdin=subprocess.DEVNULL,
                    stdout=self._stderr,
                    stderr=self._stderr,
                    pass_fds=[theirs.fileno()],
                    env=environment,
                )
            except OSError as error:
                self._connection.close()
                self._stderr.close()
                problem = f"python={python} does not start: {error.strerror}"
                raise PolicyGone(self._name, problem) from error

    def play(self, episode: PolicyEpisode) -> None:
        """Play one episode. Raises `PolicyGone`, `ServerFailed`."""
        physics, known = episode.instance.physics, dict[str, np.ndarray]()
        if PHYSICS in self._inputs:
            if own := [key for key in filter(is_attribute, physics) if physics[key] is None]:
                problem = f"{', '.join(own)} is the asset's own here, which is no number"
                raise PolicyGone(self._name, f"{problem}; evaluate where the protocol varies it")
            known[PHYSICS] = physics_vector(physics)
        self._request({"do": "reset", "seed": episode.seed + self._seed})
        about: dict[str, object] = {"do": "act", "task": episode.instruction, "count": self._count}
        while not episode.over:
            seen = observed(episode.observe(), self._pictures) | known
            for name in self._pictures:
                (_, height, width), drawn = self._inputs[name], seen[name].shape
                if drawn[:2] != (height, width):  # no episode could be played
                    size = f"{width}x{height}"
                    problem = f"learnt from {name} of {size}, drawn are {drawn[1]}x{drawn[0]}"
                    raise PolicyGone(self._name, f"{problem}; set size={size}")
            found = self._request(about, seen)
            for action in action_rows(found.get("actions"), len(seen[STATE]), self._name):
                if episode.act(action):
                    return

    def _request(
        self, about: dict[str, object], arrays: Mapping[str, np.ndarray] | None = None
    ) -> dict[str, np.ndarray]:
        answer, found = self._ask(about, arrays)
        if "error" in answer:
            raise ServerFailed(f"{self._name}: {answer['error']}\n{answer.get('trace', '')}")
        return found

    def _ask(
        self, about: dict[str, object], arrays: Mapping[str, np.ndarray] | None = None
    ) -> lerobot_server.Message:
        try:
            self._connection.send_bytes(lerobot_server.pack(about, dict(arrays or {})))
            if not self._connection.poll(self._given.reply_s):
                raise PolicyGone(self._name, f"no answer within {self._given.reply_s:g} s")
            return lerobot_server.unpack(self._connection.recv_bytes(LARGEST_MESSAGE))
        except (EOFError, OSError) as error:
            if not self._connection.closed and not self._connection.readable:
                problem = f"sent a message of more than {LARGEST_MESSAGE} bytes"
                raise PolicyGone(self._name, problem) from error
            problem = "its process has closed the connection"
            with contextlib.suppress(subprocess.TimeoutExpired):
                code = self._process.wait(FAREWELL)
                self._stderr.seek(0)
                lines = self._stderr.read().decode(errors="replace").strip().splitlines()
                last = " ".join(lines[-1:])[:LONGEST_REPORT]
                problem = f"its process ended with code {code}: {last}"
            raise PolicyGone(self._name, problem) from error
        except (ValueError, KeyError) as error:
            raise ServerFailed(f"{self._name}: answered what is no message: {error}") from error

    def close(self) -> None:
        self._connection.close()
        with contextlib.suppress(subprocess.TimeoutExpired):
            self._process.wait(FAREWELL)
        self._process.kill()
        self._process.wait()
        self._stderr.close()


def observed(observation: Observation, pictures: Mapping[str, str]) -> dict[str, np.ndarray]:
    """An observation in the names of `rtphys export lerobot`; cameras by the name of a picture."""
    poses = [observation.endposes[side] for side in ("left", "right")]
    return {
        STATE: observation.vector.astype(np.float32),
        EE_POSE: np.concatenate(poses).astype(np.float32),
        **{name: observation.cameras[camera].rgb for name, camera in pictures.items()},
    }


def physics_vector(physics: Physics) -> np.ndarray:
    """All attributes as in `rtphys export lerobot`, float32; vectors one number after the other."""
    keys = filter(is_attribute, physics)
    return np.array([part for key in keys for part in components(physics[key])], np.float32)


def pictures(inputs: Mapping[str, object], given: str) -> dict[str, str]:
    """Camera of ours by name of a picture among the checkpoint's inputs.

    Raises `BadValue`: `given` is spelled otherwise; `UnknownName`: no such camera of ours, or the
    checkpoint wants one that we do not have.
    """
    named = {name: ours for ours, names in CAMERAS.items() for name in names}
    for pair in filter(None, given.split(",")):
        ours, _, name = pair.partition("=")
        if not name:
            raise BadValue("cameras", given, "write OURS=THEIRS,OURS=THEIRS")
        if ours not in CAMERAS:
            raise UnknownName("camera", ours, CAMERAS)
        named[name] = ours
    found: dict[str, str] = {}
    for name in (name for name in inputs if name.startswith(PICTURE)):
        if (short := name.removeprefix(PICTURE)) not in named:
            cure = "the checkpoint (its names for ours: ?cameras=head=NAME,left=NAME)"
            raise UnknownName("camera", short, named, cure)
        found[name] = named[short]
    return found


def check_vectors(
    about: Mapping[str, Mapping[str, list[int]]],
    size: int,
    oracle: bool,
    physics: Physics | None = None,
) -> None:
    """Refuse a checkpoint that could play no episode of a robot with `size` numbers.

    Args:
        about: shapes of its inputs and outputs.
        oracle: whether the physics is shown to it.
        physics: of an episode; None: the task is not known yet.

    Raises `BadValue`: it reads the physics and is not shown it (as an `oracle` is), or its state or
    action is that of another robot, or its physics that of other attributes.
    """
    # Other inputs that we lack may be listed though the policy never reads them, such as effort.
    known = about["inputs"].get(PHYSICS)
    wanted = known if physics is None else [len(physics_vector(physics))]
    if known is not None and not oracle:
        cure = "the checkpoint was trained with the physics labels; ?physics=true shows them"
        raise BadValue("physics", oracle, cure)
    if oracle and known != wanted:
        problem = f"the checkpoint has to read {PHYSICS} of {wanted}, its shape there is {known}"
        raise BadValue("physics", oracle, problem)
    for name, shape, without in (
        (STATE, about["inputs"].get(STATE), None),
        ("action", about["outputs"].get("action"), [size]),
    ):
        if shape not in ([size], without):
            allowed = f"this robot has {size} numbers, so the checkpoint is another robot's"
            raise BadValue(name, shape, allowed)


def open_lerobot(argument: str, setup: PolicySetup) -> LeRobot:
    """Opener of `lerobot:PATH[?python=FILE&device=cuda ...]`: the fields of `LeRobotOptions`.

    PATH is what `lerobot-train` wrote, one of its checkpoints, or a name on the Hub.

    Raises `PolicyGone`: that Python does not start, lacks lerobot, or cannot open the checkpoint;
    `BadFile`, `UnknownName`: an option is wrong, or the folder has no checkpoint; `BadValue`: the
    checkpoint does not fit.
    """
    path, given = split_options(argument, setup.options)
    if not path:
        raise BadValue("policy", "lerobot:", "name a checkpoint's folder: lerobot:PATH")
    chosen = from_words(LeRobotOptions, given, "option", f"lerobot:{path}")
    if (folder := Path(path)).exists():
        inner = (folder / name for name in CHECKPOINTS)
        found = [one for one in inner if (one / "config.json").is_file()]
        if not found:
            raise BadFile(folder, "holds no LeRobot checkpoint (no config.json, model.safetensors)")
        path = str(found[0].resolve())
    return LeRobot(path, chosen, setup)
