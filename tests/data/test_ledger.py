"""The ledger: one spec, rows in a chain, and only a torn last line is forgiven."""

import resource
from pathlib import Path
from typing import Annotated

import pytest

from rtphys.core.errors import BadFile
from rtphys.data.faults import CannotWrite, DatasetMismatch
from rtphys.data.json_text import Model, compact
from rtphys.data.ledger import SUSPECT, Ledger, read_header, read_lines, read_rows
from rtphys.spec.option import checked_dataclass
from rtphys.spec.stored import Extent


class Row(Model):
    seed: int
    detail: str


@checked_dataclass(frozen=True)
class Part:
    width: int = 3


@checked_dataclass(frozen=True)
class Run:
    name: str
    part: Part = Part()
    episodes: Annotated[int, Extent] = 10


ROWS = [Row(seed=n, detail="größer") for n in range(5)]
RUN = Run("a")


def opened(path: Path, run: Run = RUN) -> tuple[Ledger[Run, Row], list[Row]]:
    found: list[Row] = []
    return Ledger(path, run, Row, found.append), found


@pytest.fixture
def path(tmp_path: Path) -> Path:
    ledger, _ = opened(tmp_path / "folder" / "ledger.jsonl")
    for row in ROWS:
        ledger.append(row)
    return ledger.path


def test_reads_what_was_written(path: Path) -> None:
    ledger, found = opened(path)
    assert found == ROWS == list(read_rows(Row, path)) and ledger.lines == 6
    assert read_header(Run, path) == RUN
    assert [line.check for line in read_lines(path)][-1] == ledger.check


@pytest.mark.parametrize(
    "number", ["1e999", "-1E+999", "1.5e0999", "9" * 20, f"-{'9' * 21}", "NaN", "-Infinity"]
)
@pytest.mark.parametrize("before", [b"[", b"[1,", b"[1, ", b'{"a":', b'{"a" :\t'])
def test_a_number_that_json_cannot_hold_is_suspect(before: bytes, number: str) -> None:
    assert SUSPECT.search(before + number.encode())


def test_a_digest_or_a_long_fraction_is_not_suspect() -> None:
    """Or nearly every row would be read by the slower way."""
    row = {"sha256": "3e123" + "9" * 59, "physics": [1.5e-123, 0.00012345678901234567, 2**63 - 1]}
    assert not SUSPECT.search(compact(row))  # type: ignore[arg-type]


def test_a_row_that_cannot_follow_is_named_by_its_line(path: Path) -> None:
    def add(row: Row) -> None:
        if row.seed == 2:
            raise ValueError("seed 2 follows seed 1")

    with pytest.raises(BadFile, match=r"ledger\.jsonl: line 4: seed 2 follows seed 1"):
        Ledger(path, RUN, Row, add)


def test_opening_writes_nothing(tmp_path: Path) -> None:
    ledger, found = opened(tmp_path / "a" / "ledger.jsonl")
    assert not found and not ledger.path.parent.exists() and ledger.lines == 0


def test_every_single_byte_flip_is_seen(path: Path) -> None:
    data = path.read_bytes()
    sound = [(line.text, line.check) for line in read_lines(path)]
    for place in range(len(data)):
        path.write_bytes(data[:place] + bytes([data[place] ^ 1 << place % 8]) + data[place + 1 :])
        try:
            assert [(line.text, line.check) for line in read_lines(path)] != sound
        except BadFile as error:
            assert "line" in str(error)


@pytest.mark.parametrize("lost", [1, 7, 60])
def test_a_torn_line_is_dropped_and_overwritten(path: Path, lost: int) -> None:
    whole = path.read_bytes()
    path.write_bytes(whole[:-lost])
    ledger, found = opened(path)
    assert found == ROWS[:-1]
    ledger.append(ROWS[-1], durable=False)
    assert path.read_bytes() == whole


@pytest.mark.parametrize("order", [[0, 2, 1, 3, 4], [0, 1, 3, 4], [1, 2, 3, 4]])
def test_moved_and_missing_lines_break_the_chain(path: Path, order: list[int]) -> None:
    lines = path.read_bytes().splitlines(keepends=True)
    path.write_bytes(b"".join(lines[n] for n in order))
    with pytest.raises(BadFile, match="checksum"):
        list(read_lines(path))


def test_another_spec_is_refused_and_the_field_named(path: Path) -> None:
    with pytest.raises(DatasetMismatch, match=r"part\.width was 3, now 4"):
        opened(path, Run("a", Part(4)))
    opened(path, Run("a", episodes=99))  # an extent: how much, not what


def test_a_removed_file_is_not_begun_again(path: Path) -> None:
    ledger, _ = opened(path)
    path.unlink()
    with pytest.raises(CannotWrite, match="removed while this run"):
        ledger.append(ROWS[0])
    assert not path.exists()


def test_a_refused_write_leaves_the_file_as_it_was(
    path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    whole, (ledger, _) = path.read_bytes(), opened(path)

    def full(handle: int) -> None:
        raise OSError(28, "No space left on device")

    monkeypatch.setattr("os.fsync", full)
    with pytest.raises(CannotWrite, match="the disk is full"):
        ledger.append(ROWS[0])
    assert path.read_bytes() == whole
    monkeypatch.undo()
    ledger.append(ROWS[0])
    assert opened(path)[1] == [*ROWS, ROWS[0]]


def test_a_disk_that_takes_a_part_of_a_line_says_why_it_takes_no_more(path: Path) -> None:
    """Here a limit of this process, which the system reports as it does a full disk."""
    whole, (ledger, _) = path.read_bytes(), opened(path)
    soft, hard = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (len(whole) + 9, hard))
    try:
        with pytest.raises(CannotWrite, match=r"ledger\.jsonl: File too large"):
            ledger.append(ROWS[0])
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, (soft, hard))
    assert path.read_bytes() == whole


def test_a_row_that_breaks_its_schema_is_named(path: Path) -> None:
    with pytest.raises(BadFile, match=r"line 2: .*width"):
        list(read_rows(Strict, path))


class Strict(Model):
    width: int
