"""Client of openpi's policy server: sends an observation, receives a chunk of joint targets.

The observation is that of openpi's aloha policies: `state` (14,), `images` (3, 240, 320) uint8 RGB
by `cam_high`, `cam_left_wrist`, `cam_right_wrist`, and `prompt`.
"""

import os
from collections.abc import Mapping

import numpy as np

from rtphys.core.errors import BadValue, RtphysError
from rtphys.core.poses import Array
from rtphys.data.episode import CAMERA_NAMES
from rtphys.episode import Observation, PolicyEpisode
from rtphys.policies.policy import PolicySetup, ServerFailed, action_rows
from rtphys.policies.registry import Seconds, split_options
from rtphys.policies.websocket import OPENPI, Connection, Endpoint
from rtphys.spec import recording
from rtphys.spec.option import Positive, checked_dataclass, from_words

ACTION_SIZE = 14  # numbers of an action of openpi's aloha policies
CAMERAS = {name: CAMERA_NAMES["aloha"][recording.CAMERAS[name]] for name in recording.USUAL}
KEY = "OPENPI_API_KEY"  # environment variable; a specification is stored in every result


@checked_dataclass(frozen=True)
class OpenPiOptions:
    """What may follow the server's address."""

    execute: Positive | None = None  # actions of each chunk before the next request; None: all
    reply_s: Seconds = Endpoint.reply_s
    connect_s: Seconds = Endpoint.connect_s


class OpenPi:
    """Policy behind openpi's websocket server.

    Raises `PolicyGone`: no server answers; `ServerFailed`: it fails before its greeting.
    """

    needs_images = True

    def __init__(self, at: Endpoint, execute: int | None) -> None:
        self._at, self._execute = at, execute
        self._connection: Connection | None = self._open()

    def _open(self) -> Connection:
        connection = Connection(self._at)
        try:
            connection.receive()  # its greeting, which holds nothing that is needed
        except RtphysError:
            connection.close()
            raise
        return connection

    def play(self, episode: PolicyEpisode) -> None:
        """Play one episode. Raises `PolicyGone`, `ServerFailed`."""
        while not episode.over:
            for action in self.infer(request(episode.observe(), episode.instruction)):
                if episode.act(action):
                    return

    def infer(self, observation: Mapping[str, object]) -> Array:
        """Actions (n, 14) for an observation. Raises `PolicyGone`, `ServerFailed`."""
        # After an error of its own the server closes the connection, but keeps serving.
        self._connection = self._connection or self._open()
        self._connection.send(observation)
        try:
            reply = self._connection.receive()
        except ServerFailed:
            self.close()
            raise
        if not isinstance(reply, Mapping) or "actions" not in reply:
            raise ServerFailed(f"{self._at.url}: the answer has no 'actions'")
        return action_rows(reply["actions"], ACTION_SIZE, self._at.url)[: self._execute]

    def close(self) -> None:
        if self._connection is not None:
            self._connection.close()
        self._connection = None


def request(observation: Observation, instruction: str) -> dict[str, object]:
    """Message to the server about one instant."""
    pictures = {name: observation.images[camera] for camera, name in CAMERAS.items()}
    return {
        "state": observation.vector.astype(np.float32),
        "images": {n: np.ascontiguousarray(p.transpose(2, 0, 1)) for n, p in pictures.items()},
        "prompt": instruction,
    }


def open_openpi(argument: str, setup: PolicySetup) -> OpenPi:
    """Opener of `openpi:[ws://]HOST:PORT[?execute=N&reply_s=S&connect_s=S]`.

    Raises `PolicyGone`: no server answers; `BadFile`, `UnknownName`: an option is wrong;
    `BadValue`: the robot has other than six joints an arm.
    """
    if sum(setup.arm_joints) + len(setup.arm_joints) != ACTION_SIZE:
        allowed = f"openpi's aloha policies command {ACTION_SIZE} numbers, six joints an arm"
        raise BadValue("embodiment", setup.embodiment, allowed)
    where, given = split_options(argument, setup.options)
    chosen = from_words(OpenPiOptions, given, "option", f"openpi:{where}")
    key = os.environ.get(KEY)
    headers = {"Authorization": f"Api-Key {key}"} if key else {}
    at = Endpoint(where, OPENPI, chosen.reply_s, chosen.connect_s, headers)
    return OpenPi(at, chosen.execute)
