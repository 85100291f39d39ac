"""Files of a dataset that are damaged or missing are made again, and nothing else is touched."""

import shutil
from pathlib import Path

import pytest
from collected import content
from forger import Forger, forge
from typer.testing import CliRunner

from rtphys.cli.main import app
from rtphys.core.errors import BadFile, RtphysError
from rtphys.data.dataset import Dataset
from rtphys.data.faults import DatasetLocked
from rtphys.data.layout import EpisodePaths
from rtphys.data.lock import FolderLock
from rtphys.data.verify import verify
from rtphys.studies.reproduce import damage, repair

pytestmark = [pytest.mark.sim, pytest.mark.render]


@pytest.fixture
def copied(honest: Path, tmp_path: Path) -> Path:
    return Path(shutil.copytree(honest, tmp_path / "data"))


def spoil(paths: EpisodePaths) -> None:
    """A truncated HDF5, a video that is gone, a label that is gone, an edit of the sentences."""
    paths.hdf5.write_bytes(paths.hdf5.read_bytes()[:1000])
    paths.video.unlink()
    paths.phys_meta.unlink()
    paths.instruction.write_bytes(paths.instruction.read_bytes()[::-1])


def test_what_is_damaged_comes_back_to_the_last_byte(honest: Path, copied: Path) -> None:
    first, second = Dataset(copied)
    spoil(first.paths)
    (copied / "manifest.json").unlink()
    (seeds,) = copied.rglob("seeds.txt")
    seeds.unlink()
    sound = {path: path.stat().st_mtime_ns for path in second.paths.all()}
    done = repair(copied, damage(copied), workers=1)
    made = {*first.paths.all(), copied / "manifest.json"}
    assert (set(done.files), done.problems) == (made, [])
    assert content(copied) == content(honest)
    assert sound == {path: path.stat().st_mtime_ns for path in second.paths.all()}
    assert verify(copied).sound


def test_a_sound_dataset_needs_no_simulation(
    honest: Path, copied: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("rtphys.studies.reproduce.run_here", None)
    assert repair(copied, damage(copied)).files == []
    assert content(copied) == content(honest)


def test_other_versions_are_refused_by_name(copied: Path) -> None:
    def change(forger: Forger) -> None:
        forger.header["resolved"]["versions"]["sapien"] = "2.0"
        forger.header["resolved"]["assets"]["digest"] = "0" * 64

    forge(copied, change)
    first, _ = Dataset(copied)
    first.paths.video.unlink()
    before = content(copied)
    with pytest.raises(RtphysError, match=r"sapien was '2.0', now .*; assets.digest was '000"):
        repair(copied, damage(copied))
    assert content(copied) == before


def test_what_comes_out_otherwise_is_not_written(copied: Path) -> None:
    """Its ledger lists a video that nobody has drawn."""

    def change(forger: Forger) -> None:
        forger.place.episode(0).video.write_bytes(b"x")

    forge(copied, change)
    first, _ = Dataset(copied)
    first.paths.video.unlink()
    done = repair(copied, damage(copied), workers=1)
    assert done.files == []
    assert "other bytes" in str(*done.problems)
    assert not first.paths.video.exists()


def test_without_a_ledger_nothing_is_made(copied: Path, tmp_path: Path) -> None:
    with FolderLock(copied), pytest.raises(DatasetLocked):
        damage(copied)
    (ledger,) = copied.rglob("ledger.jsonl")
    ledger.unlink()
    with pytest.raises(BadFile, match="is missing: nothing can be made again without it"):
        damage(copied)
    with pytest.raises(BadFile, match="holds no dataset"):
        damage(tmp_path)
    with pytest.raises(BadFile, match="no such folder"):
        damage(tmp_path / "nowhere")


def test_the_command_takes_no_wish(copied: Path) -> None:
    words = ["collect", "--task", "click_bell,lift_pot", "--repair", "--out", str(copied)]
    refused = CliRunner().invoke(app, words)
    assert refused.exit_code == 2 and "--task = 'click_bell,lift_pot' is not" in refused.stderr
    assert "beside --repair stand only --out and --workers" in refused.stderr.replace("\n", " ")
    done = CliRunner().invoke(app, ["collect", "--repair", "--out", str(copied)])
    assert done.exit_code == 0
    assert "0 files made again" in done.stdout
    manifest = (copied / "manifest.json").read_bytes()
    (copied / "manifest.json").unlink()
    done = CliRunner().invoke(app, ["verify", str(copied)])
    assert "a repair by `rtphys collect` writes it again" in " ".join(done.output.split())
    done = CliRunner().invoke(app, ["collect", "--repair", "--out", str(copied)])
    assert f"made again: {copied / 'manifest.json'}" in done.stdout.replace("\n", "")
    assert "1 file made again" in done.stdout
    assert (copied / "manifest.json").read_bytes() == manifest
