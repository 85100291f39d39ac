"""Python files of users, imported by path."""

import sys
from pathlib import Path

import pytest

from rtphys.core.errors import BadFile
from rtphys.core.python_file import load_file


def test_a_file_is_run_anew_and_never_taken_for_a_module_of_its_name(tmp_path: Path) -> None:
    path = tmp_path / "json.py"
    path.write_text("from dataclasses import dataclass\n@dataclass\nclass A:\n    x: int = 1\n")
    assert load_file(path, "task").A().x == 1
    path.write_text("x = 'second'\n")
    module = load_file(path, "task")
    assert module.x == "second" and not hasattr(module, "A")
    assert module.__name__.endswith(".json") and sys.modules["json"] is not module


@pytest.mark.parametrize(
    ("text", "problem"),
    [
        ("x = 1\nraise ValueError('no')\n", r"cannot be loaded: ValueError: no \(line 2\)"),
        ("\nimport nowhere_at_all\n", r"ModuleNotFoundError: .* \(line 2\)"),
        ("x = = 1\n", r"SyntaxError: invalid syntax \(bad.py, line 1\)"),
    ],
)
def test_a_file_that_raises_is_named_with_the_line(tmp_path: Path, text: str, problem: str) -> None:
    path = tmp_path / "bad.py"
    path.write_text(text)
    with pytest.raises(BadFile, match=problem) as caught:
        load_file(path, "policy")
    assert caught.value.path == path
    assert "rtphys_policy_bad" not in sys.modules


def test_what_is_no_python_file_is_refused(tmp_path: Path) -> None:
    with pytest.raises(BadFile, match="no such policy file"):
        load_file(tmp_path / "nowhere.py", "policy")
    (tmp_path / "notes.txt").write_text("x = 1\n")
    with pytest.raises(BadFile, match="is not a Python file"):
        load_file(tmp_path / "notes.txt", "policy")


def folder(root: Path, name: str, greeting: str) -> Path:
    made = root / name
    made.mkdir()
    (made / "_words.py").write_text(f"GREETING = {greeting!r}\nSEEN = []\n")
    (made / "greet.py").write_text("from ._words import GREETING, SEEN\n\nSEEN.append(1)\n")
    return made


def test_a_file_imports_the_neighbours_of_its_own_folder(tmp_path: Path) -> None:
    first, second = folder(tmp_path, "a", "hello"), folder(tmp_path, "b", "hallo")
    assert load_file(first / "greet.py", "task").GREETING == "hello"
    assert load_file(second / "greet.py", "task").GREETING == "hallo"
    assert "_words" not in sys.modules


def test_the_file_runs_at_each_call_its_neighbours_once(tmp_path: Path) -> None:
    path = folder(tmp_path, "a", "hello") / "greet.py"
    first, second = load_file(path, "task"), load_file(path, "task")
    assert first is not second
    assert second.SEEN == [1, 1]


def test_a_neighbour_may_be_written_later(tmp_path: Path) -> None:
    made = folder(tmp_path, "a", "hello")
    load_file(made / "greet.py", "task")
    (made / "_later.py").write_text("LATE = True\n")
    (made / "wave.py").write_text("from ._later import LATE\n")
    assert load_file(made / "wave.py", "task").LATE


def test_the_line_at_fault_is_named_where_it_stands(tmp_path: Path) -> None:
    made = folder(tmp_path, "a", "hello")
    (made / "_words.py").write_text("WORDS = {}\nGREETING = WORDS['en']\n")
    with pytest.raises(BadFile, match=r"greet\.py.*KeyError: 'en' \(line 2 of _words\.py\)"):
        load_file(made / "greet.py", "task")
    (made / "greet.py").write_text("\nfrom ._absent import GREETING\n")
    with pytest.raises(BadFile, match=r"No module named '\._absent' \(line 2\)"):
        load_file(made / "greet.py", "task")


def test_a_missing_file_and_another_kind_of_file_are_refused(tmp_path: Path) -> None:
    with pytest.raises(BadFile, match="no such policy file"):
        load_file(tmp_path / "mine.py", "policy")
    (tmp_path / "mine.txt").write_text("")
    with pytest.raises(BadFile, match="is not a Python file"):
        load_file(tmp_path / "mine.txt", "policy")
