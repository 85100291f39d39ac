"""What is read and written does not grow where it must not: counted, since no time is certain."""

import gc
from collections.abc import Iterator
from pathlib import Path
from typing import IO, Any

import pytest
import synthetic
from collected import wanting

from rtphys.campaign.series import Batch
from rtphys.data import files
from rtphys.data.attempts import ATTEMPT, Accepted, Rejected
from rtphys.data.compare import Comparison
from rtphys.data.dataset import Dataset
from rtphys.data.files import FileFacts
from rtphys.data.layout import TaskDataset
from rtphys.data.ledger import Ledger
from rtphys.data.verify import verify
from rtphys.data.writer import DatasetWriter, Rejection
from rtphys.studies import reproduce

SIZES = (30, 300)
SLACK = 8  # lines: first ones, which say what a ledger is of


def rows(place: TaskDataset, first: int, end: int) -> Iterator[Accepted | Rejected]:
    """Of these seeds; every odd one is rejected."""
    for seed in range(first, end):
        if seed % 2:
            yield Rejected(seed=seed, reason="slipped", detail="", physics={"friction": 0.5})
        else:
            names = [path.relative_to(place.folder) for path in place.episode(seed // 2).all()]
            yield Accepted(
                seed=seed,
                episode=seed // 2,
                frames=9,
                scene_info={"info": {"{A}": "050_bell/base0"}},
                physics={"friction": 0.5},
                files={name.as_posix(): FileFacts.of(b"") for name in names},
            )


def extend(out: Path, first: int, end: int) -> None:
    """Attempts with empty files, without a manifest that knows them."""
    place, header = TaskDataset.of(out, synthetic.header().spec), synthetic.header()
    ledger = Ledger(place.ledger, header, ATTEMPT)
    for row in rows(place, first, end):
        for name in row.files if isinstance(row, Accepted) else ():
            path = place.folder / name
            path.parent.mkdir(parents=True, exist_ok=True)
            path.write_bytes(b"")
        ledger.append(row, durable=False)


def dataset(out: Path, attempts: int, ahead: int = 0) -> Path:
    """Of so many attempts, and more that its manifest does not know."""
    extend(out, 0, attempts)
    with DatasetWriter(out) as writer:
        writer.task(wanting(attempts))
    extend(out, attempts, attempts + ahead)
    return out


class Counter:
    """Counts the lines and the files that are read in pieces, and the bytes of whole files."""

    def __init__(self, patch: pytest.MonkeyPatch) -> None:
        self.opened = self.lines = self.read = self.written = 0
        open_binary, read, replace = files.open_binary, files.read, files.replace_file

        def counted_open(path: Path) -> IO[bytes]:
            self.opened += 1
            file = open_binary(path)
            return Counted(file, self) if path.suffix == ".jsonl" else file  # type: ignore[return-value]

        def counted_read(path: Path, *most: int) -> bytes:
            data = read(path, *most)
            self.read += len(data)
            return data

        def counted_replace(path: Path, data: bytes) -> FileFacts:
            self.written += len(data)
            return replace(path, data)

        patch.setattr(files, "open_binary", counted_open)
        patch.setattr(files, "read", counted_read)
        for module in ("files", "writer"):
            patch.setattr(f"rtphys.data.{module}.replace_file", counted_replace)


class Counted:
    """A file whose lines are counted."""

    def __init__(self, file: IO[bytes], counter: Counter) -> None:
        self.file, self.counter = file, counter

    def __enter__(self) -> "Counted":
        return self

    def __exit__(self, *_: object) -> None:
        self.file.close()

    def __getattr__(self, name: str) -> Any:
        return getattr(self.file, name)

    def readline(self, most: int) -> bytes:
        line = self.file.readline(most)
        self.counter.lines += bool(line)
        return line


@pytest.fixture(params=SIZES)
def attempts(request: pytest.FixtureRequest) -> int:
    return int(request.param)


@pytest.fixture
def out(tmp_path: Path, attempts: int) -> Path:
    return dataset(tmp_path / "out", attempts)


def test_a_checkpoint_reads_nothing_and_writes_a_small_manifest(
    out: Path, attempts: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    with DatasetWriter(out) as writer:
        task = writer.task(wanting(attempts))
        writer.checkpoint()
        counter = Counter(monkeypatch)
        for seed in range(attempts, attempts + 3):
            task.record(Rejection(seed, "slipped"))
            writer.checkpoint()
        assert (counter.opened, counter.lines, counter.read) == (0, 0, 0)
        assert counter.written < 3 * 12_000, "of which the domain is most"
        monkeypatch.undo()


def test_a_run_that_goes_on_reads_each_line_once(
    out: Path, attempts: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    counter = Counter(monkeypatch)
    with DatasetWriter(out) as writer:
        task = writer.task(wanting(attempts))
        assert task.totals.attempts == attempts
        writer.checkpoint()
        assert attempts < counter.lines <= attempts + SLACK
        monkeypatch.undo()


def test_other_task_datasets_are_not_read(
    out: Path, attempts: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Their part of the manifest is taken over as it is."""
    counter = Counter(monkeypatch)
    with DatasetWriter(out) as writer:
        writer.task(wanting(1, synthetic.header(config="mine")))
        writer.checkpoint()
    assert counter.lines <= SLACK
    assert Dataset(out).where(config="phys_random").task_datasets[0].attempts == attempts


def test_a_reader_reads_no_line_before_an_episode_is_asked_for(
    out: Path, attempts: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    counter = Counter(monkeypatch)
    data = Dataset(out)
    assert (len(data), counter.lines) == (attempts // 2, 0)
    for _ in range(2):
        assert [episode.seed for episode in data] == [*range(0, attempts, 2)]
    assert counter.lines == attempts + 1


@pytest.mark.parametrize("ahead", [0, 20])
def test_verify_reads_each_line_twice_however_far_a_run_was_ahead(
    tmp_path: Path, attempts: int, ahead: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Once for the episodes, once for their scenes."""
    out = dataset(tmp_path / "ahead", attempts - ahead, ahead)
    monkeypatch.setattr("rtphys.data.verify.check_episode", lambda *_: (None, []))
    counter = Counter(monkeypatch)
    report = verify(out)
    assert (report.problems, report.newer, report.episodes) == ([], ahead, attempts // 2)
    assert attempts < counter.lines <= 2 * (attempts + 1) + SLACK


def rows_in_memory() -> int:
    return sum(isinstance(one, Accepted | Rejected) for one in gc.get_objects())


def test_a_sample_to_be_made_again_is_all_that_is_held(
    out: Path, attempts: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    held = list[int]()

    def run_here(batches: list[Batch], *_: object) -> None:
        held.append(rows_in_memory())
        batches[0].results.update(dict.fromkeys(batches[0].jobs, Comparison()))

    before = rows_in_memory()
    monkeypatch.setattr(reproduce, "run_here", run_here)
    found = reproduce.reproduced(out, 3)
    assert (len(found.episodes), len(found.rejections)) == (3, 3)
    assert held and max(held) - before <= 6 + SLACK


def test_what_is_sound_is_not_held_to_be_repaired(out: Path, attempts: int) -> None:
    held, before = list[int](), rows_in_memory()

    def at_the_end(done: int, total: int) -> None:
        if done == total:
            held.append(rows_in_memory())

    assert reproduce.damage(out, at_the_end) == []
    assert len(held) == 1 and held[0] - before <= SLACK
