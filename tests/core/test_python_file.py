"""Files of a folder import each other, whatever else has their names."""

import sys
from pathlib import Path

import pytest

from rtphys.core.errors import BadFile
from rtphys.core.python_file import load_file


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
