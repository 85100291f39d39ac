"""The libraries of tasks and domains: what is found, in which order, and what is refused."""

import os
import sys
from pathlib import Path

import pytest

from rtphys.core import library
from rtphys.core.errors import BadFile, UnknownName
from rtphys.core.library import load_file


@pytest.fixture
def own(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.setenv("RTPHYS_LIBRARY", str(tmp_path))
    (tmp_path / "tasks").mkdir()
    return tmp_path


def test_a_users_library_adds_to_the_fifty_tasks_and_hides_drafts(own: Path) -> None:
    (own / "tasks" / "zebra.py").touch()
    (own / "tasks" / "_draft.py").touch()
    tasks = library.names("tasks")
    assert tasks["click_bell"] == library.bundled() / "tasks" / "click_bell.py"
    assert tasks["zebra"] == own / "tasks" / "zebra.py"
    assert "_draft" not in tasks and len(tasks) == 51 and list(tasks) == sorted(tasks)


def test_a_library_that_is_named_twice_is_one(own: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (own / "tasks" / "zebra.py").touch()
    monkeypatch.setenv("RTPHYS_LIBRARY", f"{own}{os.pathsep}{own / 'tasks' / '..'}")
    assert library.names("tasks")["zebra"] == own / "tasks" / "zebra.py"


def test_a_name_in_two_libraries_is_refused(own: Path) -> None:
    (own / "tasks" / "click_bell.py").touch()
    with pytest.raises(library.AmbiguousName, match="task 'click_bell' exists twice") as caught:
        library.names("tasks")
    assert str(own) in str(caught.value)


def test_a_robot_is_a_folder_with_a_configuration(own: Path) -> None:
    (own / "robots" / "arm.v2").mkdir(parents=True)
    assert library.names("robots") == {}
    (own / "robots" / "arm.v2" / "config.yml").touch()
    assert library.names("robots") == {"arm.v2": own / "robots" / "arm.v2"}


def test_a_library_that_is_not_there_is_named(own: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("RTPHYS_LIBRARY", str(own / "nowhere"))
    with pytest.raises(BadFile, match="nowhere: the library folder does not exist"):
        library.roots()


def test_patterns_match_in_the_order_given_and_once() -> None:
    matched = library.matching("tasks", ["shake_bottle", "shake*", "click_bell"])
    assert matched == ("shake_bottle", "shake_bottle_horizontally", "click_bell")
    with pytest.raises(UnknownName, match=r"here: unknown task 'clik_bell'.*'click_bell'"):
        library.matching("tasks", ["clik_bell"], "here")
    with pytest.raises(UnknownName, match="did you mean 'click_bell'"):
        library.find("tasks", "clik_bell")


def test_a_suite_is_found_by_its_name_and_by_whole_names_alone(own: Path) -> None:
    (own / "tasks" / "mine").mkdir()
    for name in ("shake_two", "shake_one", "_shared"):
        (own / "tasks" / "mine" / f"{name}.py").touch()
    assert library.suites()["mine"] == ["shake_one", "shake_two"]
    assert library.matching("tasks", ["suite:mine"]) == ("shake_one", "shake_two")
    assert library.matching("tasks", ["shake_two"]) == ("shake_two",)
    assert "shake_two" not in library.matching("tasks", ["*", "shake*"])
    assert "shake_two" not in library.names("tasks") and "shake_two" in library.names("tasks", None)
    assert library.find("tasks", "shake_two") == own / "tasks" / "mine" / "shake_two.py"
    with pytest.raises(UnknownName, match=r"unknown suite 'mien'.*'mine'"):
        library.matching("tasks", ["suite:mien"])
    with pytest.raises(UnknownName, match="did you mean 'shake_two'"):
        library.matching("tasks", ["shake_tow"])


def test_a_name_in_a_suite_and_beside_it_is_refused(own: Path) -> None:
    (own / "tasks" / "mine").mkdir()
    (own / "tasks" / "mine" / "click_bell.py").touch()
    with pytest.raises(library.AmbiguousName, match="task 'click_bell' exists twice"):
        library.find("tasks", "click_bell")


def test_yaml_is_read_anew_when_the_file_changes(tmp_path: Path) -> None:
    path = tmp_path / "a.yaml"
    path.write_text("x: [1]\n")
    library.read_yaml(path)["x"] = "changed by a caller"
    assert library.read_yaml(path) == {"x": [1]}
    path.write_text("")
    assert library.read_yaml(path) == {}


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


def test_a_file_imports_the_neighbours_of_its_own_folder_once(tmp_path: Path) -> None:
    made, other = folder(tmp_path, "a", "hello"), folder(tmp_path, "b", "hallo")
    first, second = load_file(made / "greet.py", "task"), load_file(made / "greet.py", "task")
    assert first is not second and second.SEEN == [1, 1] and first.GREETING == "hello"
    assert load_file(other / "greet.py", "task").GREETING == "hallo"
    assert "_words" not in sys.modules
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
