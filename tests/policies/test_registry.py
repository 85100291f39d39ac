"""Policies by specification: names, options, and policies of the user's own."""

import json
import sys
from pathlib import Path

import pytest

from rtphys.core.errors import BadFile, BadValue, UnknownName
from rtphys.policies import (
    BUILTIN,
    PolicyGone,
    PolicySession,
    PolicySetup,
    check_options,
    check_task,
    files_digest,
    open_policy,
    parse_spec,
    registry,
)
from rtphys.policies.lerobot import LeRobotOptions
from rtphys.policies.registry import split_options
from rtphys.spec.option import from_words
from rtphys.task.spec import load_task

MINE = """
from helper import SPEED

class Mine:
    needs_images = False
    def __init__(self, setup): self.speed = SPEED * float(setup.options["gain"])
    def play(self, episode): ...
    def close(self): ...
"""


def test_no_option_is_taken_and_ignored() -> None:
    """In `collect`, `--set friction=0.05` holds an attribute; here nothing would."""
    with pytest.raises(BadValue, match=r"'friction=0\.05' is not allowed; physics follows from"):
        check_options("python:mine.py:Mine", {"gain": "2", "friction": "0.05"})
    with pytest.raises(BadValue, match="the policy expert has no options"):
        check_options("expert", {"speed": "2"})
    check_options("expert", {})
    check_options("lerobot:act", {"execute": "2"})


def test_a_missing_module_names_the_extra_that_brings_it(monkeypatch: pytest.MonkeyPatch) -> None:
    for module, cure in (("websockets", r"; `pip install 'rtphys\[serve\]'`"), ("torch", "")):

        def missing(_: str, name: str = module) -> None:
            raise ModuleNotFoundError(f"No module named {name!r}", name=name)

        monkeypatch.setattr(registry.importlib, "import_module", missing)
        with pytest.raises(PolicyGone, match=rf"finds no module '{module}'{cure}$"):
            open_policy("openpi:localhost:1")


def test_a_specification_is_name_and_argument() -> None:
    assert parse_spec("openpi:localhost:8000") == ("openpi", "localhost:8000")
    assert parse_spec("idle") == ("idle", "")
    with pytest.raises(UnknownName, match="did you mean 'random'"):
        parse_spec("randm")


@pytest.mark.parametrize("name", ["idle", "random", "jitter", "expert"])
def test_policies_without_argument_are_opened(name: str) -> None:
    assert name in BUILTIN
    assert not open_policy(name).needs_images


def test_a_plus_in_a_path_survives() -> None:
    assert split_options("a+b?ckpt=/run+1/c d", {}) == ("a+b", {"ckpt": "/run+1/c d"})
    assert split_options("a?ckpt=%2Brun", {}) == ("a", {"ckpt": "+run"})


def test_options_follow_a_question_mark_and_override_others() -> None:
    rest, given = split_options("a:1?execute=3&device=x y", {"execute": "9", "physics": "True"})
    assert (rest, given) == ("a:1", {"execute": "3", "device": "x y", "physics": "True"})
    chosen = LeRobotOptions(execute=3, device="x y", physics=True)
    assert from_words(LeRobotOptions, given, "option", "here") == chosen
    assert from_words(LeRobotOptions, {"reply_s": "2"}, "option", "here").reply_s == 2
    with pytest.raises(BadValue, match="key=value"):
        split_options("a?execute", {})


@pytest.mark.parametrize(
    ("given", "problem"),
    [
        *(("exceute=1", "did you mean 'execute'"), ("physics=perhaps", "physics: .*boolean")),
        *((f"reply_s={wrong}", "reply_s = .* is not allowed; at ") for wrong in (0, -1, "nan")),
        *((f"execute={wrong}", "execute = .* at least 1") for wrong in (0, -2)),
        *((f"execute={wrong}", "execute: .*integer") for wrong in ("True", 1.5, "two")),
        *(("reply_s=True", "reply_s: .*number"), ("observe=always", "'action' or 'chunk'")),
    ],
)
def test_a_wrong_option_is_named(given: str, problem: str) -> None:
    with pytest.raises((UnknownName, BadFile), match=f"^lerobot:act: .*{problem}"):
        open_policy(f"lerobot:act?{given}")


OPTIONAL = """
class Mine:
    needs_images = False
    def __init__(self, setup):
        self.low = float(setup.options.get("low", 0.85))
        self.high = float(setup.options["high"]) if "high" in setup.options else 1.0
        self.setup = setup
    def play(self, episode): return self.setup.options.get("actions")
    def close(self): ...

def whole(setup):
    return Mine(setup) if {**setup.options} else None
"""


def test_a_misspelt_option_of_the_users_own_policy_is_named(tmp_path: Path) -> None:
    (tmp_path / "mine.py").write_text(OPTIONAL)
    spec = f"python:{tmp_path / 'mine.py'}:Mine"
    for given in ({"low": "0.9"}, {"low": "0.9", "high": "2"}, {"actions": "3"}):  # read later
        policy = open_policy(spec, PolicySetup(options=given))
        assert policy.low == float(given.get("low", 0.85))  # type: ignore[attr-defined]
        assert json.loads(json.dumps(policy.setup.options)) == given  # type: ignore[attr-defined]
    for wrong, right in (("lwo", "low"), ("hihg", "high")):
        said = f"unknown option of the policy '{wrong}'; did you mean '{right}'"
        with pytest.raises(UnknownName, match=said):
            open_policy(spec, PolicySetup(options={wrong: "0.9"}))


AWAY = """
import os
class Away:
    needs_images = False
    def __init__(self, setup): ...
    def play(self, episode): os.chdir("/")
    def close(self): ...
"""


def test_a_session_finds_its_file_again_though_the_policy_has_changed_the_folder(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "away.py").write_text(AWAY)
    monkeypatch.chdir(tmp_path)
    session = PolicySession("python:away.py:Away")
    for task in ("one", "two"):
        session.policy(PolicySetup(task)).play(None)  # type: ignore[arg-type]
    assert Path.cwd() == Path("/")


def test_a_policy_of_the_script_that_cannot_run_in_a_task_is_refused() -> None:
    pot, blocks = load_task("lift_pot"), load_task("heavy_below")
    with pytest.raises(BadValue, match=r"policy = 'feels' .*lift_pot has no `feel`"):
        check_task("feels", pot, ("clean",))
    with pytest.raises(UnknownName, match="did you mean 'shuffled'"):
        check_task("expert:shufled", pot, ("clean",))
    with pytest.raises(UnknownName, match="physics of lift_pot 'object_mass@first'"):
        check_task("expert:object_mass@first=2", pot, ("clean",))
    for fine in ("feels", "expert", "expert:object_mass@first=2", "python:not_yet:make"):
        check_task(fine, blocks, ("clean", "phys_random"))


def test_a_policy_of_the_users_own_may_import_its_neighbours(tmp_path: Path) -> None:
    """Its file may be called as a module of Python's own, and as one in another folder."""
    (tmp_path / "helper.py").write_text("SPEED = 2.0\n")
    mine, other = tmp_path / "random.py", tmp_path / "other" / "random.py"
    mine.write_text(MINE)
    policy = open_policy(f"python:{mine}:Mine", PolicySetup(options={"gain": "3"}))
    assert policy.speed == 6.0  # type: ignore[attr-defined]
    other.parent.mkdir()
    other.write_text("x = 1\ndef broken(setup): return 3\nclass Mine: ...\n")
    with pytest.raises(BadValue, match=r"returned type int, which has no play\(episode\)"):
        open_policy(f"python:{other}:broken")
    with pytest.raises(UnknownName, match="did you mean 'Mine'"):
        open_policy(f"python:{other}:Mime")
    other.write_text("x = 1\nmake = y\n")
    with pytest.raises(BadFile, match=r"NameError.*\(line 2\)"):
        open_policy(f"python:{other}:make")
    with pytest.raises(BadFile, match="no such policy file"):
        open_policy(f"python:{tmp_path / 'absent.py'}:make")


@pytest.mark.parametrize(
    ("spec", "problem"),
    [
        ("python:mine", "write python:MODULE:ATTRIBUTE"),
        ("python:no_such_module_anywhere:Mine", "Python finds no module"),
        ("replay:", "name a dataset's folder"),
        ("idle:fast", "idle takes no argument"),
    ],
)
def test_a_wrong_argument_is_named(spec: str, problem: str) -> None:
    with pytest.raises(BadValue, match=problem):
        open_policy(spec)


def test_a_missing_dataset_is_named(tmp_path: Path) -> None:
    with pytest.raises(BadFile, match="no such dataset"):
        open_policy(f"replay:{tmp_path / 'none'}")


def test_the_digest_follows_the_files_that_a_specification_names(tmp_path: Path) -> None:
    file, folder = tmp_path / "mine.py", tmp_path / "checkpoint"
    trained, other = tmp_path / "act", tmp_path / "other.yml"
    last = trained / "checkpoints" / "last"
    for made in (folder, last / "pretrained_model"):
        made.mkdir(parents=True)
    for spec, path in [
        (f"python:{file}:make", file),
        (f"robotwin:{file}?ckpt=3", file),
        (f"robotwin:{file}", file.with_suffix(".yml")),
        (f"robotwin:{file}?config={other}", other),
        (f"lerobot:{folder}?python=/bin/python", folder / "model.safetensors"),
        (f"lerobot:{trained}", last / "pretrained_model" / "model.safetensors"),
        (f"lerobot:{last}", last / "pretrained_model" / "config.json"),
        (f"replay:{folder}", folder / "manifest.json"),
    ]:
        path.write_text("one")
        before = files_digest(spec)
        assert before and files_digest(spec) == before
        path.write_text("two")
        assert files_digest(spec) not in ("", before)
    assert files_digest("idle") == files_digest("python:package.module:make") == ""
    many = "+".join(["friction=0.5"] * 40)  # longer than the name of any file
    assert files_digest(f"expert:{many}") == files_digest(f"lerobot:{'x' * 300}") == ""
    weights, digests = tmp_path / "act.npz", list[str]()
    for text in ("one", "two"):
        weights.write_text(text)
        options = {"low": "0.9", "weights": str(weights)}
        digests.append(files_digest(f"python:{file}:make", options))
    for text in ("one", "two"):  # a folder of weights
        (folder / "click_bell.pt").write_text(text)
        digests.append(files_digest(f"python:{file}:make", {"weights": str(folder)}))
    assert len({*digests, files_digest(f"python:{file}:make", {"low": "x" * 10_000})}) == 5
    assert files_digest(f"python:{file}:make", {"low": "0.9"}) == files_digest(
        f"python:{file}:make"
    )


def test_a_module_that_was_edited_has_another_digest(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """In the spelling of the documents, which names no file: `python:my_policy:make`."""
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(sys, "path", [*sys.path])
    package = tmp_path / "own_package" / "inner"
    package.mkdir(parents=True)
    (package.parent / "__init__.py").write_text("raise ImportError('nobody imports it yet')")
    (package / "__init__.py").write_text("")
    for spec, path in [
        ("python:edited_policy:make", tmp_path / "edited_policy.py"),
        ("python:own_package.acting:make", package.parent / "acting.py"),
        ("python:own_package.inner:make", package / "network.py"),
        ("python:own_package:make", package / "network.py"),
    ]:
        path.write_text("one")
        before = files_digest(spec)
        assert before and files_digest(spec) == before
        path.write_text("two")
        assert files_digest(spec) not in ("", before), spec
    for nothing in ("python:make", "python::make", "python:.:make", "python:os.nothing:make"):
        assert files_digest(nothing) == "", nothing
