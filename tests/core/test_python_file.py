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
    assert module.__name__ == "rtphys_task_json" and sys.modules["json"] is not module


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
