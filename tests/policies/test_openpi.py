"""openpi's websocket, end to end against servers in threads."""

import socket
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager

import numpy as np
import pytest
from servers import serving
from websockets.sync.server import ServerConnection

from rtphys.assets.pack import default_pack
from rtphys.core.errors import BadValue
from rtphys.episode import PolicyEpisode, begin
from rtphys.policies import PolicyGone, PolicySetup, ServerFailed
from rtphys.policies.openpi import OpenPi, open_openpi, request
from rtphys.policies.websocket import OPENPI
from rtphys.spec.episode import EpisodeSpec
from rtphys.task.spec import load_task

pytestmark = pytest.mark.sim
Handler = Callable[[ServerConnection], None]
ZERO = {"actions": np.zeros((1, 14))}


@contextmanager
def served(handler: Handler, options: str = "") -> Iterator[OpenPi]:
    with serving(handler) as where:
        policy = open_openpi(f"{where}{options}", PolicySetup())
        yield policy
        policy.close()


def answering(answer: Callable[[int], object], seen: list[dict] | None = None) -> Handler:
    """A server that answers its nth request with these actions."""
    asked = [] if seen is None else seen

    def handle(socket: ServerConnection) -> None:
        socket.send(OPENPI.pack({"policy": "repeats"}))
        for raw in socket:
            message = OPENPI.unpack(raw)  # type: ignore[arg-type]
            assert isinstance(message, dict)
            asked.append(message)
            actions = answer(len(asked) - 1)
            socket.send(OPENPI.pack({"actions": actions, "server_timing": {"infer_ms": 0.1}}))

    return handle


def test_a_served_recording_rings_the_bell(
    episode: PolicyEpisode, expert_actions: np.ndarray
) -> None:
    def chunk(n: int) -> object:  # ten rows of a recording after the other, then the last one
        return expert_actions[10 * n : 10 * n + 10] if 10 * n < len(expert_actions) else rest

    rest, seen = expert_actions[-1:], list[dict]()
    with served(answering(chunk, seen)) as policy:
        policy.play(episode)
    assert episode.success
    assert len(seen) == -(-episode.taken // 10)
    first = seen[0]
    assert first["prompt"] == episode.instruction
    assert first["state"].shape == (14,) and first["state"].dtype == np.float32
    shades = {"cam_high": 10, "cam_left_wrist": 20, "cam_right_wrist": 30}
    assert first["images"].keys() == shades.keys()
    for name, picture in first["images"].items():
        assert picture.shape == (3, 240, 320) and picture.dtype == np.uint8
        assert picture[:, 0, 0].tolist() == [shades[name], 0, 255]  # red first
    # The state that the server sees is the command that it gave last.
    np.testing.assert_allclose(seen[1]["state"], expert_actions[9], atol=1e-6)


def test_a_robot_with_other_numbers_and_no_address_are_refused_before_a_server_is_asked() -> None:
    panda = PolicySetup("click_bell", embodiment="franka-panda", arm_joints=(7, 7))
    with pytest.raises(BadValue, match=r"franka-panda.*14 numbers, six joints an arm"):
        open_openpi("127.0.0.1:9", panda)
    with pytest.raises(BadValue, match="HOST:PORT"):
        open_openpi("", PolicySetup())


def test_part_of_a_chunk_can_be_carried_out() -> None:
    with served(answering(lambda _: np.zeros((10, 14))), "?execute=3") as policy:
        assert policy.infer({"state": np.zeros(14)}).shape == (3, 14)


def test_a_traceback_is_the_policys_failure_and_the_next_episode_goes_on(
    episode: PolicyEpisode,
) -> None:
    calls: list[int] = []

    def handle(socket: ServerConnection) -> None:
        socket.send(OPENPI.pack({}))
        for _ in socket:
            calls.append(1)
            if len(calls) == 1:
                socket.send("Traceback: out of memory")
                socket.close(1011)
                return
            socket.send(OPENPI.pack(ZERO))

    with served(handle) as policy:
        with pytest.raises(ServerFailed, match="out of memory"):
            policy.play(episode)
        assert policy.infer({}).shape == (1, 14)


NAN = np.zeros((10, 14))
NAN[1, 3] = np.nan


@pytest.mark.parametrize(
    ("actions", "problem"),
    [(NAN, "action 1 of 10 is not finite")]
    + [(of, "actions") for of in (np.zeros((2, 7)), np.zeros((0, 14)), "left", NAN[None], None)],
)
def test_an_answer_that_is_no_actions_is_the_policys_failure(actions: object, problem: str) -> None:
    with served(answering(lambda _: actions)) as policy, pytest.raises(ServerFailed, match=problem):
        policy.infer({})


def test_a_slow_server_is_waited_for_and_a_silent_one_is_gone() -> None:
    slow = answering(lambda _: time.sleep(0.6) or np.zeros(14))
    with served(slow) as patient:
        assert patient.infer({}).shape == (1, 14)
    silent = pytest.raises(PolicyGone, match=r"no answer within 0\.1 s")
    with served(slow, "?reply_s=0.1") as hasty, silent:
        hasty.infer({})


def test_nobody_there() -> None:
    with socket.socket() as free:
        free.bind(("127.0.0.1", 0))
        port = free.getsockname()[1]
    with pytest.raises(PolicyGone, match=f"127.0.0.1:{port}.*no server answered"):
        open_openpi(f"127.0.0.1:{port}?connect_s=0.1", PolicySetup())


def test_a_server_that_dies_is_gone(episode: PolicyEpisode) -> None:
    def handle(socket: ServerConnection) -> None:
        socket.send(OPENPI.pack({}))
        socket.recv()
        socket.close()

    with served(handle) as policy, pytest.raises(PolicyGone, match="the server is gone"):
        policy.play(episode)


@pytest.mark.render
def test_it_sees_the_world() -> None:
    seen: list[dict] = []
    episode = begin(EpisodeSpec("click_bell").at(0), load_task("click_bell"), default_pack())
    with served(answering(lambda _: np.zeros((1, 14)), seen)) as policy:
        policy.infer(request(episode.observe(), episode.instruction))
    views = seen[0]["images"]
    assert all(view.std() > 5 for view in views.values())
    assert not np.array_equal(views["cam_left_wrist"], views["cam_right_wrist"])
