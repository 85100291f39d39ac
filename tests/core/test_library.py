"""The libraries of tasks and domains: what is found, in which order, and what is refused."""

from pathlib import Path

import pytest

from rtphys.core import library
from rtphys.core.errors import BadFile, UnknownName


@pytest.fixture
def own(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.setenv("RTPHYS_LIBRARY", str(tmp_path))
    (tmp_path / "tasks").mkdir()
    return tmp_path


def test_the_bundled_library_has_the_fifty_tasks() -> None:
    tasks = library.names("tasks")
    assert len(tasks) == 50 and list(tasks) == sorted(tasks)
    assert library.find("tasks", "click_bell") == library.bundled() / "tasks" / "click_bell.py"


def test_a_users_library_adds_names_and_hides_drafts(own: Path) -> None:
    (own / "tasks" / "zebra.py").touch()
    (own / "tasks" / "_draft.py").touch()
    tasks = library.names("tasks")
    assert tasks["zebra"] == own / "tasks" / "zebra.py"
    assert "_draft" not in tasks and len(tasks) == 51


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


def test_yaml_is_read_anew_when_the_file_changes(tmp_path: Path) -> None:
    path = tmp_path / "a.yaml"
    path.write_text("x: [1]\n")
    library.read_yaml(path)["x"] = "changed by a caller"
    assert library.read_yaml(path) == {"x": [1]}
    path.write_text("")
    assert library.read_yaml(path) == {}


@pytest.mark.parametrize(
    ("content", "problem"),
    [
        (b"a: 1\nb: [", "broken YAML at line [23], column"),
        (b"- 1\n", "must be a mapping of names to values"),
        (b"1: 2\n", "must be a mapping of names to values"),
        (b"a: \xff\n", "is not UTF-8 text"),
        (b"[" * 100, "nested too deeply"),
        (b"[" * 5000, "nested too deeply|maximum nesting depth"),  # PyYAML before, from 6.0.4
    ],
)
def test_a_file_that_is_no_yaml_mapping_is_named(
    tmp_path: Path, content: bytes, problem: str
) -> None:
    path = tmp_path / "bad.yaml"
    path.write_bytes(content)
    with pytest.raises(BadFile, match=problem) as caught:
        library.read_yaml(path)
    assert str(caught.value).startswith(str(path))
    with pytest.raises(BadFile, match="no such file"):
        library.read_yaml(tmp_path / "nowhere.yaml")
