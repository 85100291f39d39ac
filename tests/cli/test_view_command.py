"""`rtphys view`: whole recordings, and a viewer of the version that wrote them."""

import sys
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest

from pages import ran
from rtphys.cli.show import check_viewer
from rtphys.core.errors import BadFile, RtphysError
from rtphys.data.faults import CannotWrite


def test_a_recording_is_whole_or_what_was_there_stays(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    rerun, view = pytest.importorskip("rerun"), pytest.importorskip("rtphys.view")
    monkeypatch.setattr(view, "blueprint", lambda _: None)
    episode = SimpleNamespace(name="episode")

    def fails(stream: Any, *_: object) -> None:
        stream.log("label", rerun.TextDocument("half"))
        raise BadFile("a.hdf5", "is damaged")

    (there := tmp_path / "there.rrd").write_text("a recording")
    monkeypatch.setattr(view, "log_episode", fails)
    with pytest.raises(BadFile):
        view.record(episode, [], there)
    assert there.read_text() == "a recording"
    monkeypatch.setattr(view, "log_episode", lambda *_: None)
    (tmp_path / "folder.rrd").mkdir()
    for path in (tmp_path / "folder.rrd", there / "a.rrd"):
        with pytest.raises(CannotWrite):
            view.record(episode, [], path)
    view.record(episode, [], there)
    assert there.read_bytes()[:3] == b"RRF"
    assert sorted(path.name for path in tmp_path.iterdir()) == ["folder.rrd", "there.rrd"]


def test_a_name_that_is_not_utf_8_is_refused(tmp_path: Path) -> None:
    done = ran(["view", str(tmp_path), "--out", "b\udcff.rrd"], 2)
    assert "it is not UTF-8" in done.stderr


def test_a_viewer_of_another_version_is_refused(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    for name, version in (("own", "0.24.1"), ("first", "0.41.0")):
        viewer = tmp_path / name / "rerun"
        viewer.parent.mkdir()
        viewer.write_text(f"#!/bin/sh\necho 'rerun-cli {version} (native_viewer) [rustc 1.98]'\n")
        viewer.chmod(0o755)
    monkeypatch.setattr(sys, "executable", str(tmp_path / "own/python"))
    monkeypatch.setenv("PATH", str(tmp_path / "first"))
    check_viewer("0.24.1")  # the one beside this Python, whatever comes first on PATH
    with pytest.raises(RtphysError, match=r"own/rerun is Rerun 0\.24\.1, .* written by 0\.41\.0"):
        check_viewer("0.41.0")
    (tmp_path / "own/rerun").unlink()
    (tmp_path / "first/rerun").unlink()
    with pytest.raises(RtphysError, match="is not on PATH"):
        check_viewer("0.41.0")
