"""Failed attempts that are kept: beside the episodes, never among them, through kills."""

from pathlib import Path

import pytest
from collected import FAILURE, FRAMES, collect, content, content_but_pictures, keep

from rtphys.core.errors import BadFile
from rtphys.data.attempts import Rejected, read_attempts
from rtphys.data.dataset import Dataset, find_episode
from rtphys.data.faults import DatasetMismatch
from rtphys.data.rewrite import convert
from rtphys.data.verify import verify


@pytest.fixture(scope="module")
def kept(tmp_path_factory: pytest.TempPathFactory) -> Path:
    out = tmp_path_factory.mktemp("kept")
    keep(out)
    return out


def test_failures_lie_beside_the_episodes(kept: Path) -> None:
    data = Dataset(kept)
    assert [episode.seed for episode in data] == [0, 1, 3, 4, 6]
    assert [failure.seed for failure in data.failures()] == [2, 5]
    first = data.failures()[0]
    assert first.failure is not None and first.failure.model_dump() == FAILURE
    assert data[0].failure is None and len(first) == FRAMES
    assert first.image("head_camera", 0).shape == data[0].image("head_camera", 0).shape
    (entry,) = data.task_datasets
    assert (entry.rejections, entry.episodes, entry.failures) == ({"slipped": 2}, 5, 2)
    rows = [row for row in read_attempts(entry.below(kept).ledger) if isinstance(row, Rejected)]
    files = [row.kept for row in rows if row.kept is not None]
    assert [(one.number, one.event, one.time) for one in files] == [
        (0, "slip", 0.12),
        (1, "slip", 0.12),
    ]
    assert find_episode(first.paths.video) == first
    report = verify(kept)
    assert (report.problems, report.episodes, report.failures, report.files) == ([], 5, 2, 34)


def test_the_episodes_are_the_same_without(kept: Path, tmp_path: Path) -> None:
    collect(tmp_path, 5)
    plain = content(tmp_path)
    with_failures = content(kept)
    own = {name for name in plain if not name.endswith((".jsonl", "manifest.json"))}
    assert own and all(plain[name] == with_failures[name] for name in own)
    assert all("/failures/" in name for name in with_failures.keys() - plain.keys())


def test_no_more_are_kept_than_were_asked_for(tmp_path: Path) -> None:
    keep(tmp_path, "1")
    assert [failure.seed for failure in Dataset(tmp_path).failures()] == [2]
    assert verify(tmp_path).problems == []


def test_a_byte_of_a_failure_that_flips_is_found(kept: Path) -> None:
    for path in Dataset(kept).failures()[1].paths.all():
        data = path.read_bytes()
        path.write_bytes(data[:-9] + bytes([data[-9] ^ 1]) + data[-8:])
        assert any(problem.path == path for problem in verify(kept).problems)
        path.write_bytes(data)
    assert verify(kept).problems == []


def test_what_a_kill_leaves_is_removed_and_made_again(kept: Path, tmp_path: Path) -> None:
    """A commit was cut off between the files and the ledger."""
    keep(tmp_path, attempts=5)
    (first,) = Dataset(tmp_path).failures()
    for path in first.paths.all():
        torn = path.with_name(path.name.replace("0000000", "0000001"))
        torn.write_bytes(path.read_bytes())
    assert verify(tmp_path).problems == []
    keep(tmp_path)
    assert content(tmp_path) == content(kept)


@pytest.mark.parametrize("other", [None, "3"])
def test_another_number_is_another_collection(kept: Path, other: str | None) -> None:
    with pytest.raises(DatasetMismatch, match="keep_failures was 'all'"):
        keep(kept, other)


def test_conversion_keeps_them_and_comes_back(kept: Path, tmp_path: Path) -> None:
    convert(kept, tmp_path / "legacy", "legacy")
    assert verify(tmp_path / "legacy").problems == []
    assert [one.seed for one in Dataset(tmp_path / "legacy").failures()] == [2, 5]
    convert(tmp_path / "legacy", tmp_path / "again", "native")
    assert content_but_pictures(tmp_path / "again") == content_but_pictures(kept)


def test_a_failure_that_is_missing_is_named(kept: Path, tmp_path: Path) -> None:
    keep(tmp_path, attempts=3)
    lost = Dataset(tmp_path).failures()[0].paths.hdf5
    lost.unlink()
    assert any(problem.path == lost for problem in verify(tmp_path).problems)
    with pytest.raises(BadFile, match=lost.name):
        keep(tmp_path, attempts=4)
