"""Client of XPolicyLab's policy server, and its data format v1.0 of observations and actions.

A frame is a map of `message_type`, `message_id`, `evaluation_id`, `action_case_id`, `trial_id`,
`repeat_index`, `step`, `sent_at` and `payload`, and nothing else: the server refuses other keys.
There is a frame per request and a frame per answer.
"""

from collections.abc import Mapping, Sequence
from contextlib import suppress
from datetime import UTC, datetime
from itertools import count
from typing import Annotated

import numpy as np

from rtphys.assets.action_layout import SIDES
from rtphys.core.bounds import LONGEST_REPORT, MAX_STALE
from rtphys.core.errors import RtphysError, UnknownName
from rtphys.core.poses import Array, Pose
from rtphys.data.episode import CAMERA_KEYS
from rtphys.episode import Observation, PolicyEpisode
from rtphys.episode.control import ActionKind, shape_of
from rtphys.policies.policy import PolicySetup, ServerFailed
from rtphys.policies.registry import Seconds, split_options
from rtphys.policies.websocket import MSGPACK_NUMPY, Connection, Endpoint
from rtphys.spec import recording
from rtphys.spec.option import checked_dataclass, from_words, one_of

ANSWERS = {
    "hello": "hello_ack",
    "prepare_case": "prepare_case_ack",
    "reset": "reset_result",
    "infer": "infer_result",
    "trial_end": "trial_end_ack",
}
EVALUATION = "rtphys"
CAMERAS = {name: CAMERA_KEYS[official] for name, official in recording.CAMERAS.items()}
KINDS: dict[str, ActionKind] = {"joint": "qpos", "qpos": "qpos", "ee": "ee", "endpose": "ee"}
FREQUENCY = 30  # [Hz] what RoboTwin's client says by default; servers use it as a label
# Names under which an action may come, the present one first (RoboTwin's client accepts all).
ARM_NAMES: dict[ActionKind, tuple[str, ...]] = {
    "qpos": ("{}_arm_joint_state", "{}_arm_joint", "{}_joint_state"),
    "ee": ("{}_ee_pose", "{}_endpose"),
}
GRIPPER_NAMES = ("{}_ee_joint_state", "{}_gripper", "{}_gripper_pos")
PARTS = (*ARM_NAMES["qpos"], *ARM_NAMES["ee"], *GRIPPER_NAMES)
NAMES = {"action_type", *(part.format(side) for part in PARTS for side in SIDES)}
"""Every key that an action may have."""


@checked_dataclass(frozen=True)
class XPolicyLabOptions:
    """What may follow the server's address."""

    # The meaning of actions that are plain arrays; mappings state theirs.
    action_type: Annotated[str, one_of("action_type", KINDS)] = "joint"
    reply_s: Seconds = Endpoint.reply_s
    connect_s: Seconds = Endpoint.connect_s


class XPolicyLab:
    """Policy behind XPolicyLab's websocket server, with actions of one of `KINDS`.

    Raises `PolicyGone`: no server answers; `ServerFailed`: the server refuses the greeting.
    """

    needs_images = True

    def __init__(self, at: Endpoint, kind: str) -> None:
        self._at, self._kind = at, kind
        self._numbers = count(1)
        self._trial: dict[str, object] = {"action_case_id": None, "trial_id": None}
        self._connection = Connection(at)
        try:
            self._request("hello", {})
        except RtphysError:
            self.close()
            raise

    def play(self, episode: PolicyEpisode) -> None:
        """Play one episode. Raises `PolicyGone`, `ServerFailed`."""
        case = f"{episode.task}-{episode.protocol}"
        trial = f"{case}-{episode.seed}"
        self._trial = {"action_case_id": case, "trial_id": trial}
        what: dict[str, object] = {"task_name": episode.task, "seed": episode.seed}
        about = {**what, "instruction": episode.instruction, "action_type": self._kind}
        self._request("prepare_case", {"action_case_id": case, **about})
        self._request("reset", {"trial_id": trial, **about})
        for step in count():
            if episode.over:
                break
            now = episode.observe()
            asked = {"observation": observation_of(now, episode.instruction)}
            payload = self._request("infer", asked, step)
            if "actions" not in payload:
                raise ServerFailed(f"{self._at.url}: the answer has no 'actions'")
            for answer in chunk_of(payload["actions"], self._at.url):
                # Parts that an answer omits keep their present value, not that at its start.
                action, kind = action_of(answer, self._kind, now, self._at.url)
                if episode.act(action, kind) or episode.over:
                    break
                now = episode.observe()
        with suppress(RtphysError):  # the episode is decided, whatever the server does now
            self._request("trial_end", {"trial_id": trial, **what, "success": episode.success})

    def _request(
        self, kind: str, payload: Mapping[str, object], step: int = 0
    ) -> Mapping[str, object]:
        """The answer's payload. Raises `PolicyGone`, `ServerFailed`."""
        number, url = f"{EVALUATION}-{next(self._numbers)}", self._at.url
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
        for _ in range(MAX_STALE):  # answers to requests that an earlier error has abandoned
            frame = self._connection.receive()
            if not isinstance(frame, Mapping):
                raise ServerFailed(f"{url}: sent a {type(frame).__name__}, not a frame")
            if frame.get("message_id") == number:
                break
        else:
            raise ServerFailed(f"{url}: {MAX_STALE} messages, none of them the answer")
        answered, found = frame.get("message_type"), frame.get("payload") or {}
        if not isinstance(found, Mapping):
            raise ServerFailed(f"{url}: sent a {type(found).__name__} as payload")
        if answered == "error":
            problem = f"{found.get('code', 'internal')}: {found.get('message', '')}"
            raise ServerFailed(f"{url}: {kind} failed: {problem[:LONGEST_REPORT]}")
        if answered != ANSWERS[kind]:
            raise ServerFailed(f"{url}: answered {kind} with {answered!r}")
        return found

    def close(self) -> None:
        self._connection.close()


def open_xpolicylab(argument: str, setup: PolicySetup) -> XPolicyLab:
    """Opener of `xpolicylab:[ws://]HOST:PORT[?action_type=ee&reply_s=S&connect_s=S]`.

    Raises `PolicyGone`: no server answers; `BadFile`, `UnknownName`: an option is wrong.
    """
    where, given = split_options(argument, setup.options)
    chosen = from_words(XPolicyLabOptions, given, "option", f"xpolicylab:{where}")
    at = Endpoint(where, MSGPACK_NUMPY, chosen.reply_s, chosen.connect_s)
    return XPolicyLab(at, chosen.action_type)


def observation_of(now: Observation, instruction: str) -> dict[str, object]:
    """Observation of one instant in XPolicyLab's format; poses xyz [m] + wxyz, world frame."""
    state: dict[str, object] = {}
    robot = now.embodiment
    for limb, part in zip(robot.limbs, robot.action_layout.sides, strict=True):
        side, X_ET = limb.side, Pose((limb.hand.tcp, 0.0, 0.0))  # tool centre point in the ee frame
        joints = now.vector[part].astype(np.float32)
        ee = now.endposes[side]
        tcp = Pose(ee[:3], ee[3:]) @ X_ET
        state[f"{side}_arm_joint_state"] = joints[:-1]
        state[f"{side}_ee_joint_state"] = joints[-1:]
        state[f"{side}_ee_pose"] = ee.astype(np.float32)
        state[f"{side}_tcp_pose"] = np.concatenate([tcp.p, tcp.q]).astype(np.float32)
    vision = {
        CAMERAS[name]: {
            "color": view.rgb,
            "shape": view.rgb.shape[:2],
            "intrinsic_matrix": view.intrinsic_cv,
            "extrinsics_matrix": view.extrinsic_cv,
        }
        for name, view in now.cameras.items()
    }
    return {
        "data_format_version": "v1.0",
        "instruction": instruction,
        "instructions": [instruction],
        "env_idx": 0,
        "vision": vision,
        "state": state,
        "additional_info": {"frequency": FREQUENCY},
    }


def chunk_of(actions: object, where: str) -> list[object]:
    """Split an answer into single actions, each a mapping or a row of numbers.

    Raises `ServerFailed`: the answer holds no action.
    """
    if isinstance(actions, Mapping):
        return chunk_of(actions["actions"], where) if "actions" in actions else [actions]
    if isinstance(actions, np.ndarray):
        rows: list[object] = list(np.atleast_2d(actions))
    elif isinstance(actions, Sequence) and not isinstance(actions, str | bytes):
        single = len(actions) > 0 and isinstance(actions[0], int | float | np.number)
        rows = [actions] if single else list(actions)
    else:
        raise ServerFailed(f"{where}: answered actions as {type(actions).__name__}")
    if not rows:
        raise ServerFailed(f"{where}: answered no action")
    return rows


def action_of(answer: object, kind: str, now: Observation, where: str) -> tuple[Array, ActionKind]:
    """Convert an action for `PolicyEpisode.act`.

    It is a row of numbers of this `kind`, or a mapping of named parts, which may state its own
    kind; those that it omits keep their value `now`.

    Raises `ServerFailed`: neither a mapping of known parts nor a row of the right length.
    """
    named = answer if isinstance(answer, Mapping) else {}
    action_type = str(named.get("action_type", kind))
    if action_type not in KINDS:
        raise ServerFailed(f"{where}: action_type {action_type!r} is none of {', '.join(KINDS)}")
    ours = KINDS[action_type]
    for key in named:
        if key not in NAMES:
            raise ServerFailed(f"{where}: {UnknownName('part of an action', str(key), NAMES)}")
    parts: list[object] = [answer]
    if named:
        parts.clear()
        for side, at in zip(SIDES, now.embodiment.action_layout.sides, strict=True):
            numbers = now.vector[at]
            present = numbers[:-1] if ours == "qpos" else now.endposes[side]
            for names, kept in ((ARM_NAMES[ours], present), (GRIPPER_NAMES, numbers[-1:])):
                keys = (name.format(side) for name in names)
                parts.append(next((named[key] for key in keys if key in named), kept))
    try:
        row = np.concatenate([np.asarray(part, float).reshape(-1) for part in parts])
    except (TypeError, ValueError) as error:
        raise ServerFailed(f"{where}: an action holds no numbers: {error}") from error
    size, what = shape_of(ours, now.embodiment)
    if row.shape != (size,):
        raise ServerFailed(f"{where}: an action has {row.size} numbers, not {size} ({what})")
    return row, ours
