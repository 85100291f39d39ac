"""Which options a policy has read, in whatever way and however late."""

import json
from collections.abc import Callable, Mapping
from copy import deepcopy
from pathlib import Path
from typing import Any

import pytest

from rtphys.policies import PolicySession, PolicySetup
from rtphys.policies.options import AskedOptions, unread_options

GIVEN = {"low": "0.9", "height": "0.03"}
WHOLE: list[Callable[[Any], Mapping[str, str]]] = [
    dict,
    deepcopy,
    lambda options: {**options},
    lambda options: dict(**options),
    lambda options: options.copy(),
    lambda options: options | {},
    lambda options: {} | options,
    lambda options: {key: options[key] for key in options},
    lambda options: dict(options.items()),
    lambda options: dict(zip(options.keys(), options.values(), strict=True)),
    lambda options: json.loads(json.dumps(options)),
]


@pytest.mark.parametrize("whole", WHOLE)
def test_options_that_are_read_all_together_are_read(
    whole: Callable[[Any], Mapping[str, str]],
) -> None:
    options = AskedOptions(GIVEN)
    assert options.unread == set(GIVEN)
    assert whole(options) == GIVEN
    assert options.unread == set()


@pytest.mark.parametrize(
    "one",
    [
        lambda options: options["low"],
        lambda options: options.get("low", "1"),
        lambda options: options.pop("low"),
        lambda options: options.setdefault("low", "1"),
        lambda options: "low" in options,
    ],
)
def test_an_option_that_is_read_by_name_is_read_alone(one: Callable[[Any], object]) -> None:
    options = AskedOptions(GIVEN)
    assert one(options) and len(options) and options.unread == {"height"}


POLICY = """
class Late:
    needs_images = False
    def __init__(self, setup): self.options = setup.options
    def play(self, episode): self.options.get(episode)
    def close(self): ...
"""


def test_a_session_knows_what_was_never_read_however_often_it_opened(tmp_path: Path) -> None:
    (tmp_path / "late.py").write_text(POLICY)
    session = PolicySession(f"python:{tmp_path / 'late.py'}:Late")
    assert session.unread is None
    session.policy(PolicySetup("one", options=GIVEN)).play("low")  # type: ignore[arg-type]
    assert session.unread == {"height"}
    session.policy(PolicySetup("two", options=GIVEN))
    session.close()
    assert session.unread == {"height"}, "the first opening has read it"
    session.policy(PolicySetup("two", options=GIVEN)).play("height")  # type: ignore[arg-type]
    assert session.unread == set()


def test_a_session_finds_its_file_again_though_the_policy_has_changed_the_folder(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    away = "import os\nclass Late(Late):\n    def play(self, episode): os.chdir('/')\n"
    (tmp_path / "away.py").write_text(POLICY + away)
    monkeypatch.chdir(tmp_path)
    session = PolicySession("python:away.py:Late")
    for task in ("one", "two"):
        session.policy(PolicySetup(task)).play(None)  # type: ignore[arg-type]
    assert Path.cwd() == Path("/")


def test_what_no_worker_has_read_is_one_line() -> None:
    first, second = frozenset({"height", "low"}), frozenset({"height", "speed"})
    said = "note: python:reach.py:make never read the option height"
    assert unread_options("python:reach.py:make", [first, second]) == said
    said = "note: mine never read the options height, low"
    assert unread_options("mine", [first, first]) == said
    assert unread_options("mine", [first, frozenset()]) == unread_options("mine", []) == ""
