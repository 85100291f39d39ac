"""Whose dataset it is: its digest in one line."""

import json
import re
from pathlib import Path

import pytest
import synthetic
from collected import FOLDER, collect
from typer.testing import CliRunner, Result

from rtphys.cli.main import app
from rtphys.data.check_episode import Problem
from rtphys.data.dataset import Dataset
from rtphys.data.state_digests import state_digest
from rtphys.data.writer import DatasetWriter, Rejection
from rtphys.studies import reproduce
from rtphys.studies.reproduce import Reproduction


@pytest.fixture
def dataset(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "cache"))
    collect(tmp_path / "dataset", 1)
    return tmp_path / "dataset"


def verify(dataset: Path, *options: str) -> Result:
    return CliRunner().invoke(app, ["verify", str(dataset), "--quick", *options])


def test_the_digest_is_one_line_that_a_change_of_any_file_changes(dataset: Path) -> None:
    result = verify(dataset)
    assert result.exit_code == 0
    (digest,) = re.findall(r"^digest (sha256:[0-9a-f]{64})$", result.stdout, re.MULTILINE)
    assert verify(dataset, "--expect", digest).exit_code == 0
    other = f"sha256:{'0' * 64}"
    result = verify(dataset, "--expect", other)
    assert result.exit_code == 1
    assert f"the dataset is {digest}, not the expected {other}" in result.stdout
    assert f"digest {digest}" in result.stdout.splitlines(), "it is sound, though another"


def test_a_digest_is_refused_that_can_be_none(dataset: Path) -> None:
    result = verify(dataset, "--expect", "sha256:abc")
    assert result.exit_code == 2
    assert "64 hexadecimal digits" in result.stderr
    result = verify(dataset, "--expect", "abc")
    assert result.exit_code == 2
    assert "unknown published collection 'abc'" in result.stderr


def test_it_is_compared_with_what_was_published(dataset: Path, tmp_path: Path) -> None:
    (episode,) = Dataset(dataset)
    digests = {str(episode.seed): state_digest(episode)[:16]}
    task = {"config": episode.config, "attempts": 1, "rejections": {}, "frames": 1}
    task |= {"sentences": 1, "bytes": 1, "cpu_seconds": 1.0, "episodes": digests}
    listed = {"what": "", "command": "", "dataset_version": "3.0", "driver": ""}
    path = tmp_path / "ours.digests.json"
    path.write_text(json.dumps({**listed, "tasks": {episode.task: task}}))
    result = verify(dataset, "--expect", str(path))
    assert result.exit_code == 0
    assert "1 of 1 episode of 1 task have the states, actions and labels of" in result.stderr
    digests[str(episode.seed)] = 16 * "0"
    path.write_text(json.dumps({**listed, "tasks": {episode.task: task}}))
    result = verify(dataset, "--expect", str(path))
    assert result.exit_code == 1 and "its states or its label are not those of" in result.stdout
    path.write_text(json.dumps({**listed, "tasks": {"lift_pot": task}}))
    result = verify(dataset, "--expect", str(path))
    assert result.exit_code == 1 and "it holds no episode of" in result.stdout


@pytest.mark.parametrize("name", ["video/episode_0000000.mp4", "seeds.txt", "manifest.json"])
@pytest.mark.parametrize("how", ["damaged", "missing"])
def test_a_damaged_dataset_has_no_digest_and_its_cure_is_named(
    dataset: Path, name: str, how: str
) -> None:
    folder = dataset if name == "manifest.json" else dataset / FOLDER
    if how == "missing":
        (folder / name).unlink()
    else:
        (folder / name).write_bytes((folder / name).read_bytes()[:-4])
    result = verify(dataset)
    assert result.exit_code == 1
    assert not re.search(r"^digest", result.output, re.MULTILINE)
    cure = f"to make damaged and missing files again: rtphys collect --repair --out {dataset}"
    assert (cure in result.stderr) is ((name, how) != ("manifest.json", "damaged"))
    if name != "manifest.json":
        assert "whose manifest it has: files are damaged or missing" in result.stdout


def test_what_was_not_made_again_as_it_is_has_no_digest(
    dataset: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    found = Reproduction(episodes=["click_bell, seed 0"])
    monkeypatch.setattr(reproduce, "reproduced", lambda *_: found)
    result = verify(dataset, "--reproduce", "1")
    assert result.exit_code == 0
    (digest,) = re.findall(r"^digest (sha256:[0-9a-f]{64})$", result.stdout, re.MULTILINE)
    found.problems.append(Problem(dataset / "data.hdf5", "not as made again: left_arm"))
    result = verify(dataset, "--reproduce", "1")
    assert result.exit_code == 1
    assert not re.search(r"^digest", result.output, re.MULTILINE)
    assert (
        f"it is not the dataset {digest}, whose manifest it has: it was not made" in result.stdout
    )


def test_what_is_newer_than_the_manifest_is_covered_by_no_digest(dataset: Path) -> None:
    digest = verify(dataset).stdout.split()[1]
    manifest = (dataset / "manifest.json").read_bytes()
    with DatasetWriter(dataset) as writer:
        task = writer.task(synthetic.header())
        task.record(Rejection(task.next_seed, "slipped"))
    (dataset / "manifest.json").write_bytes(manifest)
    assert verify(dataset).exit_code == 0  # a run may go on here
    result = verify(dataset, "--expect", digest)
    assert "1 newer attempt in the folder" in result.stdout


def test_failures_are_no_episodes(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "cache"))
    collect(tmp_path / "kept", 9, synthetic.header(keep_failures="all"), attempts=7)
    assert "sound (5 episodes, 2 kept failures, " in verify(tmp_path / "kept").stdout
