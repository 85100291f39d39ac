"""A corpus of hostile datasets through the readers: an error of ours, soon, and nothing outside."""

import shutil
from collections.abc import Callable, Sequence
from pathlib import Path

import pytest
import synthetic
from hostile import Hostile, corpus
from test_dataset_writer import collect
from time_limit import Hang, at_most

from rtphys.core.errors import RtphysError
from rtphys.data.convert import convert
from rtphys.data.dataset import Dataset
from rtphys.data.verify import verify
from rtphys.data.writer import DatasetWriter
from rtphys.export.croissant import CardText, croissant
from rtphys.report.facts import gather

SECONDS = 10
SECRET = "the secret of another folder"
CASES = tuple(corpus())


def _collect(dataset: Path, _: Path) -> None:
    with DatasetWriter(dataset) as writer:
        writer.task(synthetic.conditions(), 1)


def _read(dataset: Path, _: Path) -> None:
    for episode in Dataset(dataset):
        _ = (episode.frames, episode.physics, episode.instructions, len(episode))


READERS: dict[str, Callable[[Path, Path], object]] = {
    "verify-manifest": lambda dataset, _: verify(dataset),
    "Dataset": _read,
    "convert": lambda dataset, out: convert(dataset, out, "legacy"),
    "report": lambda dataset, _: gather(Dataset(dataset)),
    "export": lambda dataset, _: croissant(Dataset(dataset), CardText("name")),
    "collect": _collect,
}


@pytest.fixture(scope="module")
def sound(tmp_path_factory: pytest.TempPathFactory) -> Path:
    out = tmp_path_factory.mktemp("sound")
    collect(out, 1)
    return out


def state(folder: Path) -> dict[str, tuple[int, int]]:
    """Size and time of every file, of folders the time alone."""
    paths = [folder, *folder.rglob("*")]
    return {str(p): (p.lstat().st_size, p.lstat().st_mtime_ns) for p in paths}


def complaint(case: Hostile, reader: str, sound: Path, room: Path) -> str:
    """What is wrong with a reader's answer to a case; empty if nothing is."""
    dataset, outside = room / "dataset", room / "outside"
    shutil.copytree(sound, dataset)
    outside.mkdir()
    (outside / "secret.txt").write_text(SECRET)
    case.apply(dataset, outside)
    before = state(outside)
    try:
        with at_most(SECONDS):
            READERS[reader](dataset, room / "out")
    except RtphysError as error:
        if not str(error) or len(str(error)) > 5000 or SECRET in str(error):
            return f"{case}: {reader} says {str(error)[:100]!r}"
    except (Exception, Hang) as error:
        return f"{case}: {reader} raised {type(error).__name__}: {str(error)[:150]}"
    if state(outside) != before or {p.name for p in room.iterdir()} - {"dataset", "outside", "out"}:
        return f"{case}: {reader} wrote outside"
    return ""


def check(cases: Sequence[Hostile], reader: str, sound: Path, tmp_path: Path) -> None:
    wrong = []
    for number, case in enumerate(cases):
        room = tmp_path / str(number)
        room.mkdir()
        wrong += [text] if (text := complaint(case, reader, sound, room)) else []
        shutil.rmtree(room)
    assert not wrong, f"{len(wrong)} of {len(cases)}:\n" + "\n".join(wrong)


@pytest.mark.parametrize("reader", READERS)
def test_some_hostile_datasets(reader: str, sound: Path, tmp_path: Path) -> None:
    """Every sixth case, each by one reader."""
    first = 6 * list(READERS).index(reader)
    check(CASES[first :: 6 * len(READERS)], reader, sound, tmp_path)


@pytest.mark.slow
@pytest.mark.parametrize("reader", READERS)
def test_hostile_datasets(reader: str, sound: Path, tmp_path: Path) -> None:
    assert len(CASES) > 1500
    check(CASES, reader, sound, tmp_path)
