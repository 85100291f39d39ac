"""Names and paths out of a file: nothing leads out of the folder, and nothing is waited for."""

import os
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st
from time_limit import at_most

from rtphys.core.errors import BadFile
from rtphys.core.library import read_yaml
from rtphys.core.untrusted import check_inside, plain_name, read_file


@given(st.text(max_size=300))
def test_a_name_that_passes_is_one_component(text: str) -> None:
    try:
        name = plain_name(text)
    except ValueError:
        return
    assert name == text and Path("root", name).parent == Path("root") and name not in ("", "..")


def test_our_own_names_pass() -> None:
    for name in ("phys_random.friction=0.05", "mine.twin=clean", "m.center_of_mass=0,0,0.01"):
        assert plain_name(name) == name


def test_only_an_ordinary_file_is_read(tmp_path: Path) -> None:
    os.mkfifo(tmp_path / "fifo")
    (tmp_path / "file").write_bytes(b"12345")
    (tmp_path / "link").symlink_to("file")
    assert read_file(tmp_path / "file", 5) == b"12345"
    assert read_file(tmp_path / "link", links=True) == b"12345"
    for path, said in (
        (tmp_path / "fifo", "no ordinary file"),
        (Path("/dev/zero"), "no ordinary file"),
        (tmp_path, "no ordinary file"),
        (tmp_path / "link", "is a link"),
        (tmp_path / "none", "no such file"),
    ):
        with pytest.raises(BadFile, match=said):
            read_file(path)
    with pytest.raises(BadFile, match="the most that is read"):
        read_file(tmp_path / "file", 4)


def test_a_link_on_the_way_is_named(tmp_path: Path) -> None:
    (tmp_path / "a").mkdir()
    (tmp_path / "a/b").symlink_to("/etc")
    check_inside(tmp_path, tmp_path / "a/c/d")
    with pytest.raises(BadFile, match="a/b: is a link"):
        check_inside(tmp_path, tmp_path / "a/b/hostname")


def bomb(levels: int, wide: int) -> str:
    lines = ["a0: &a0 [x, x]"]
    lines += [f"a{n}: &a{n} [{', '.join([f'*a{n - 1}'] * wide)}]" for n in range(1, levels)]
    return "\n".join(lines)


HOSTILE = {
    bomb(9, 9): "more than 8 aliases",
    bomb(40, 2): "more than 8 aliases",
    "a: &a [*a]": "a contains itself",
    "a: 1\nb: 2\na: 3": "line 3, column 1: key 'a' occurs twice",
    "a: {b: {c: 1, c: 2}}": "key 'c' occurs twice",
    "a: " + "[" * 100: "nested too deeply",
    "a: " + "[" * 1000: "nested too deeply|maximum nesting depth",  # PyYAML before, from 6.0.4
    "a: " + "9" * 5000: "more than 64 bits",
    "a: 0x" + "f" * 20: "more than 64 bits",
    'a: "\\ud800"': "invalid Unicode character",
    "- 1\n" * 60_000: "must be a mapping of names to values",
    "1: 2": "must be a mapping of names to values",
    "a: 1\nb: [": "broken YAML at line [23], column",
    "a: \udcff": "is not UTF-8 text",  # byte ff
    "a: !!timestamp x": "does not fit its tag",
    "a: !!int x": "invalid literal",
    "a: !!bool x": "does not fit its tag",
    "a: !!python/object/apply:os.system [ls]": "could not determine a constructor",
    "? [a]\n: 1": "unhashable key",
    "x" * 300_000: "the most that is read",
}


@pytest.mark.parametrize("text", HOSTILE, ids=range(len(HOSTILE)))
def test_it_is_refused_in_one_sentence(text: str, tmp_path: Path) -> None:
    path = tmp_path / "a.yaml"
    path.write_text(text, errors="surrogateescape")
    with at_most(20), pytest.raises(BadFile, match=HOSTILE[text]) as caught:
        read_yaml(path)
    assert str(caught.value).startswith(str(path)) and len(str(caught.value)) < 300


def test_a_few_aliases_and_a_merge_are_read(tmp_path: Path) -> None:
    path = tmp_path / "a.yaml"
    path.write_text("a: &a {x: 1}\nb: *a\nc: {<<: *a, y: 2}")
    assert read_yaml(path) == {"a": {"x": 1}, "b": {"x": 1}, "c": {"x": 1, "y": 2}}
