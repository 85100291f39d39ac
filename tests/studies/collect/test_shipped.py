"""Results that come from another machine: their files land where those of this one are."""

import os
from dataclasses import replace
from pathlib import Path

import pytest

from rtphys.data import files
from rtphys.studies import collect_worker as work
from rtphys.studies.collect_worker import OtherMachine, SerializedEpisode, own_folder

CONTENTS = {"data.hdf5": b"numbers", "video.mp4": b"pictures"}


@pytest.fixture
def shipped(tmp_path: Path) -> SerializedEpisode:
    there = tmp_path / "there"
    there.mkdir()
    facts = {name: files.write_synced(there / name, data) for name, data in CONTENTS.items()}
    return SerializedEpisode(7, there, 3, facts, {}, {}, CONTENTS)


def test_files_land_in_the_folder_of_their_seed(shipped: SerializedEpisode, tmp_path: Path) -> None:
    here = tmp_path / "seed_7"
    here.mkdir()
    (here / "left.over").touch()
    landed = shipped.written(here)
    assert (landed.seed, landed.folder) == (7, here)
    assert {path.name: path.read_bytes() for path in here.iterdir()} == CONTENTS


def test_damage_on_the_way_is_seen(shipped: SerializedEpisode, tmp_path: Path) -> None:
    damaged = replace(shipped, contents={**CONTENTS, "video.mp4": b"picturez"})
    with pytest.raises(OtherMachine, match=r"seed_7/video.mp4: it was damaged on its way"):
        damaged.written(tmp_path / "seed_7")


@pytest.mark.parametrize("name", ["../out", "/elsewhere/out", "data.hdf5/../../out", "", "other"])
def test_files_that_no_episode_has_do_not_land(
    name: str, shipped: SerializedEpisode, tmp_path: Path
) -> None:
    odd = replace(shipped, contents={**CONTENTS, name: b"x"})
    with pytest.raises(OtherMachine, match="an episode has no file"):
        odd.written(tmp_path / "a" / "seed_7")
    assert not (tmp_path / "a").exists() and not [*tmp_path.rglob("out")]


def test_folders_of_dead_processes_are_removed(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(work.tempfile, "gettempdir", lambda: str(tmp_path))
    own = own_folder()
    dead = own.parent / "999999999"
    dead.mkdir()
    (own / "kept").touch()
    assert own_folder() == own
    assert own.name == str(os.getpid())
    assert not dead.exists() and (own / "kept").exists()
