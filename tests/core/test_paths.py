"""Names and paths out of a file: nothing leads out of the folder, and nothing is waited for."""

import os
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from rtphys.core.errors import BadFile
from rtphys.core.paths import check_inside, plain_name, plain_path, read_file

PARTS = st.sampled_from(["..", ".", "", "/", "a", "\0", "\\", "~", "\ud800", "x" * 300])


@given(st.lists(PARTS | st.text(max_size=6), max_size=6).map("/".join))
def test_a_path_that_passes_stays_below(text: str) -> None:
    try:
        path = plain_path(text)
    except ValueError:
        return
    below = os.path.normpath(f"/base/{path}")
    assert below == f"/base/{text}" and not Path(text).is_absolute()


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
