"""A server whose actions are in other units or too few, through the client and the worker."""

import re
from collections.abc import Callable

import numpy as np
import pytest
from servers import serving
from websockets.sync.server import ServerConnection

from rtphys.assets.pack import default_pack
from rtphys.core.poses import Array
from rtphys.policies import PolicySetup
from rtphys.policies.websocket import OPENPI
from rtphys.results import EpisodeRecord
from rtphys.spec.episode import EpisodeSpec
from rtphys.studies import evaluate
from rtphys.studies.evaluate import EvaluateWorker, EvaluationTask

pytestmark = pytest.mark.sim
STEPS = 12
HANDS = np.isin(np.arange(14), (6, 13))

# What a server answers instead of joints [rad] and openings -> reason and what the record names.
LANGUAGES: dict[str, tuple[Callable[[Array], Array], str, str]] = {
    "degrees": (
        lambda row: np.where(HANDS, row, np.degrees(row)),
        "step_limit",
        r"^joints are beyond their limits in .*: degrees\?$",
    ),
    "wrong length": (
        lambda row: row[:7],
        "policy_error",
        r"ServerFailed: .*actions of shape \(1, 7\), not \(n, 14\)$",
    ),
}


def played(
    said: Callable[[Array], Array], actions: Array, monkeypatch: pytest.MonkeyPatch
) -> EpisodeRecord:
    """The record of the first steps of an episode, whose server says these actions its own way."""

    def handle(socket: ServerConnection) -> None:
        socket.send(OPENPI.pack({}))
        for row, _ in zip(actions, socket, strict=False):
            socket.send(OPENPI.pack({"actions": said(row)[None]}))

    begin = evaluate.begin

    def short(*of):
        episode = begin(*of)
        episode.step_limit = STEPS
        return episode

    monkeypatch.setattr(evaluate, "begin", short)
    job = EvaluationTask(EpisodeSpec("click_bell", "clean").at(0), PolicySetup("click_bell"))
    with serving(handle) as where:
        worker = EvaluateWorker(default_pack(), f"openpi:{where}")
        record = worker.do(job).record
        worker.finish()
    return record


@pytest.mark.parametrize("language", LANGUAGES)
def test_the_record_names_it(
    language: str, expert_actions: Array, painted: None, monkeypatch: pytest.MonkeyPatch
) -> None:
    said, reason, named = LANGUAGES[language]
    record = played(said, expert_actions, monkeypatch)
    assert (record.success, record.reason) == (False, reason)
    line = record.language or record.detail.strip().splitlines()[-1]
    assert re.search(named, line), line
    assert set(record.clipped.values()) <= {*range(1, STEPS + 1)}
    if language == "degrees":
        assert any(name.startswith("right_joint_") for name in record.clipped), record.clipped


def test_who_speaks_our_language_is_not_suspected(
    expert_actions: Array, painted: None, monkeypatch: pytest.MonkeyPatch
) -> None:
    record = played(lambda row: row, expert_actions, monkeypatch)
    assert (record.reason, record.language, record.clipped) == ("step_limit", "", {})
