"""XPolicyLab's policy server: framed requests, each answered by a frame of its own.

A frame is a map of `message_type`, `message_id`, `evaluation_id`, `action_case_id`, `trial_id`,
`repeat_index`, `step`, `sent_at` and `payload`, and nothing else: the server forbids extra keys.
"""

from collections.abc import Mapping
from contextlib import suppress
from datetime import UTC, datetime
from itertools import count

from rtphys.core.errors import BadValue
from rtphys.episode import Observation, PolicyEpisode
from rtphys.policies import options
from rtphys.policies.policy import PolicySetup
from rtphys.policies.served import xpolicylab_format as fmt
from rtphys.policies.served.connection import (
    CONNECTION_OPTIONS,
    Connection,
    Endpoint,
    ServerFailed,
    endpoint,
)
from rtphys.policies.served.wire import MSGPACK_NUMPY

ANSWERS = {
    "hello": "hello_ack",
    "prepare_case": "prepare_case_ack",
    "reset": "reset_result",
    "infer": "infer_result",
    "trial_end": "trial_end_ack",
}
EVALUATION = "rtphys"


class XPolicyLab:
    """A policy behind XPolicyLab's websocket (`rtphys.policies.Policy`).

    Args:
        at: where; speaks `wire.MSGPACK_NUMPY`.
        kind: "joint" or "ee", what plain arrays of actions mean; mappings say it themselves.

    Raises:
        PolicyGone: nobody answers there.
        ServerFailed: the server refuses the hello.
    """

    needs_images = True

    def __init__(self, at: Endpoint, kind: str = "joint") -> None:
        if kind not in fmt.KINDS:
            raise BadValue("action_type", kind, f"it is one of {', '.join(fmt.KINDS)}")
        self._at, self._kind = at, kind
        self._numbers = count(1)
        self._trial: dict[str, object] = {"action_case_id": None, "trial_id": None}
        self._connection = Connection(at)
        self._request("hello", {})

    def play(self, episode: PolicyEpisode) -> None:
        """Raises `PolicyGone`, `ServerFailed`."""
        case = f"{episode.task}-{episode.protocol}"
        trial = f"{case}-{episode.seed}"
        self._trial = {"action_case_id": case, "trial_id": trial}
        told: dict[str, object] = {
            "task_name": episode.task,
            "seed": episode.seed,
            "instruction": episode.instruction,
            "action_type": self._kind,
        }
        self._request("prepare_case", {"action_case_id": case, **told})
        self._request("reset", {"trial_id": trial, **told})
        step = 0
        while not episode.over:
            self._act_out(episode, step)
            step += 1
        end = {"task_name": episode.task, "seed": episode.seed, "success": episode.success}
        with suppress(ServerFailed):  # whatever it makes of the news, the episode is decided
            self._request("trial_end", {"trial_id": trial, **end})

    def _act_out(self, episode: PolicyEpisode, step: int) -> None:
        now: Observation = episode.observe()
        asked = {"observation": fmt.observation(now, episode.instruction)}
        payload = self._request("infer", asked, step)
        if "actions" not in payload:
            raise ServerFailed(f"{self._at.url}: the answer has no 'actions'")
        for answer in fmt.chunk(payload["actions"], self._at.url):
            # What an answer leaves out stays as it is now, not as it was when the chunk began.
            action, kind = fmt.action(answer, self._kind, now, self._at.url)
            if episode.act(action, kind) or episode.over:
                return
            now = episode.observe()

    def _request(
        self, kind: str, payload: Mapping[str, object], step: int = 0
    ) -> Mapping[str, object]:
        number = f"{EVALUATION}-{next(self._numbers)}"
        self._connection.send(
            {
                "message_type": kind,
                "message_id": number,
                "evaluation_id": EVALUATION,
                **self._trial,
                "repeat_index": None,
                "step": step,
                "sent_at": datetime.now(UTC).isoformat(),
                "payload": payload,
            }
        )
        while True:  # answers to requests that an earlier error abandoned are not ours
            frame = self._connection.receive()
            if not isinstance(frame, Mapping):
                raise ServerFailed(f"{self._at.url}: sent no frame")
            if frame.get("message_id") == number:
                return self._payload(frame, kind)

    def _payload(self, frame: Mapping[object, object], asked: str) -> Mapping[str, object]:
        found, payload = frame.get("message_type"), frame.get("payload") or {}
        assert isinstance(payload, Mapping)
        if found == "error":
            problem = f"{payload.get('code', 'internal')}: {payload.get('message', '')}"
            raise ServerFailed(f"{self._at.url}: {asked} failed: {problem}")
        if found != ANSWERS[asked]:
            raise ServerFailed(f"{self._at.url}: answered {asked} with {found!r}")
        return payload

    def close(self) -> None:
        self._connection.close()


def open_xpolicylab(argument: str, setup: PolicySetup) -> XPolicyLab:
    """`xpolicylab:HOST:PORT[?action_type=ee&reply_s=S&connect_s=S]`; `ws://` may stand before it.

    Raises:
        PolicyGone: nobody answers there.
        BadValue, UnknownName: an option is wrong.
    """
    where, given = options.split(argument, setup.options)
    options.only(given, (*CONNECTION_OPTIONS, "action_type"), f"xpolicylab:{where}")
    return XPolicyLab(endpoint(where, MSGPACK_NUMPY, given), str(given.get("action_type", "joint")))
