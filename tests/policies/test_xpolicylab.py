"""XPolicyLab's websocket, end to end against a server that is as strict as theirs."""

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Any

import numpy as np
import pytest
from servers import serving
from websockets.sync.server import ServerConnection

from rtphys.core.errors import BadFile
from rtphys.episode import PolicyEpisode
from rtphys.policies import PolicyGone, PolicySetup, ServerFailed
from rtphys.policies.websocket import MSGPACK_NUMPY
from rtphys.policies.xpolicylab import XPolicyLab, action_of, chunk_of, open_xpolicylab

pytestmark = pytest.mark.sim

Frame = dict[str, Any]
KEYS = {
    "message_type", "message_id", "evaluation_id", "action_case_id", "trial_id",
    "repeat_index", "step", "sent_at", "payload",
}  # fmt: skip
ANSWER = {"hello": "hello_ack", "prepare_case": "prepare_case_ack", "reset": "reset_result"}
ANSWER |= {"infer": "infer_result", "trial_end": "trial_end_ack"}


@contextmanager
def served(infer: Callable[[Frame], Frame], log: list[Frame]) -> Iterator[XPolicyLab]:
    """The client of a server that accepts frames of the exact form alone, and answers each."""

    def handle(socket: ServerConnection) -> None:
        for raw in socket:
            frame: Any = MSGPACK_NUMPY.unpack(raw)  # type: ignore[arg-type]
            log.append(frame)
            wrong, kind = set(frame) ^ KEYS, frame["message_type"]
            reply, answer = ANSWER.get(kind), {"ok": True}
            if wrong or reply is None:
                reply, answer = "error", {"code": "invalid_frame", "message": str(wrong)}
            elif kind == "infer":
                answer = infer(frame["payload"]["observation"])
                reply = "error" if "code" in answer else reply
            socket.send(MSGPACK_NUMPY.pack({**frame, "message_type": reply, "payload": answer}))

    with serving(handle) as where:
        policy = open_xpolicylab(where, PolicySetup())
        yield policy
        policy.close()


def named(row: np.ndarray) -> Frame:
    """An action as XPolicyLab's models give it."""
    return {
        "left_arm_joint_state": row[:6].astype(np.float32),
        "left_ee_joint_state": row[6:7].astype(np.float32),
        "right_arm_joint_state": row[7:13].astype(np.float32),
        "right_ee_joint_state": row[13:].astype(np.float32),
    }


def test_a_served_recording_rings_the_bell(
    episode: PolicyEpisode, expert_actions: np.ndarray
) -> None:
    log: list[Frame] = []
    left = [named(row) for row in expert_actions]

    def infer(observation: Frame) -> Frame:
        now, left[:8] = left[:8], []
        return {"actions": now or [named(expert_actions[-1])], "latency_ms": 0.1}

    with served(infer, log) as policy:
        policy.play(episode)
    assert episode.success
    kinds = [frame["message_type"] for frame in log]
    assert kinds[:3] == ["hello", "prepare_case", "reset"] and kinds[-1] == "trial_end"
    assert set(kinds[3:-1]) == {"infer"}
    assert log[-1]["payload"]["success"] is True
    assert log[1]["payload"]["instruction"] == episode.instruction
    assert [frame["step"] for frame in log[3:-1]] == list(range(len(log) - 4))
    assert len({frame["message_id"] for frame in log}) == len(log)
    observation = log[3]["payload"]["observation"]
    assert observation["data_format_version"] == "v1.0"
    assert observation["instruction"] == episode.instruction
    for name, shade in (("cam_head", 10), ("cam_left_wrist", 20), ("cam_right_wrist", 30)):
        camera = observation["vision"][name]
        assert camera["color"].shape == (240, 320, 3) and camera["color"].dtype == np.uint8
        assert camera["color"][0, 0].tolist() == [shade, 0, 255]
        assert camera["shape"] == [240, 320] and camera["intrinsic_matrix"].shape == (3, 3)
    for side in ("left", "right"):
        assert observation["state"][f"{side}_arm_joint_state"].shape == (6,)
        assert observation["state"][f"{side}_ee_joint_state"].tolist() == [1.0]
        ee, tcp = (observation["state"][f"{side}_{what}_pose"] for what in ("ee", "tcp"))
        assert np.linalg.norm(tcp[:3] - ee[:3]) == pytest.approx(0.12, abs=1e-5)


def test_end_effector_actions(episode: PolicyEpisode) -> None:
    now = episode.observe()
    shift = np.array([0.0, 0.0, 0.02, 0, 0, 0, 0])
    row, kind = action_of({"left_ee_pose": now.endposes["left"] + shift}, "ee", now, "server")
    assert kind == "ee"
    # What the answer leaves out stays where it is.
    np.testing.assert_array_equal(row[8:15], now.endposes["right"])
    assert row[[7, 15]].tolist() == [1.0, 1.0]
    episode.act(row, kind)
    moved = episode.observe().endposes["left"][:3] - now.endposes["left"][:3]
    np.testing.assert_allclose(moved, shift[:3], atol=4e-3)


def test_rows_of_numbers_will_do(episode: PolicyEpisode, expert_actions: np.ndarray) -> None:
    now, three = episode.observe(), expert_actions[:3]
    for answer in (three, three.tolist(), {"actions": three}):
        rows = [action_of(a, "joint", now, "server")[0] for a in chunk_of(answer, "server")]
        np.testing.assert_array_equal(rows, three)
    for number in (float, np.float32):
        assert len(chunk_of([*map(number, expert_actions[0])], "server")) == 1


@pytest.mark.parametrize(
    "answer",
    [
        {"code": "infer_failed", "message": "out of memory"},
        {"nothing": 1},
        {"actions": []},
        {"actions": "left"},
        {"actions": [{"left_arm_joint_state": np.zeros(7)}]},
        {"actions": [np.zeros(9)]},
        {"actions": [{"left_arm_joint_state": "far"}]},
        {"actions": [{"action_type": "torque"}]},
        {"actions": [{"left_arm_joint_sate": np.zeros(6)}]},
    ],
)
def test_a_bad_answer_is_the_policys_failure_and_the_next_episode_goes_on(
    answer: Frame, new_episode: Callable[[], PolicyEpisode]
) -> None:
    with served(lambda _: answer, []) as policy:
        for _ in range(2):
            with pytest.raises(ServerFailed, match=r"^ws://127\.0\.0\.1:\d+: "):
                policy.play(new_episode())


@pytest.mark.parametrize("last", [None, b"\xc1", "Traceback"])
def test_an_episode_is_decided_whatever_the_server_does_at_its_end(
    last: bytes | str | None, new_episode: Callable[[], PolicyEpisode]
) -> None:
    """Where it closed the connection instead, no run could finish its last episode."""

    def handle(socket: ServerConnection) -> None:
        for raw in socket:
            frame: Any = MSGPACK_NUMPY.unpack(raw)  # type: ignore[arg-type]
            kind, answer = frame["message_type"], {}
            if kind == "trial_end":
                if last is None:
                    return
                socket.send(last)
                continue
            if kind == "infer":
                state = frame["payload"]["observation"]["state"]
                answer = {"actions": {key: state[key] for key in state if "joint_state" in key}}
            socket.send(
                MSGPACK_NUMPY.pack({**frame, "message_type": ANSWER[kind], "payload": answer})
            )

    with serving(handle) as where:
        policy = open_xpolicylab(where, PolicySetup())
        episode = new_episode()
        episode.step_limit = 2
        policy.play(episode)
        assert episode.taken == 2
        if last is None:
            with pytest.raises(PolicyGone):
                policy.play(new_episode())
        policy.close()


def test_wrong_options_are_named() -> None:
    with pytest.raises(BadFile, match="unknown action_type 'torque'"):
        open_xpolicylab("localhost:1?action_type=torque", PolicySetup())
