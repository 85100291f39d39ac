"""The journal's chain: only a torn last line is forgiven."""

from pathlib import Path

import pytest

from rtphys.core.errors import BadFile
from rtphys.data.journal import Journal, read_journal

ENTRIES = [{"seed": n, "verdict": "rejected", "detail": "größer"} for n in range(5)]


@pytest.fixture
def path(tmp_path: Path) -> Path:
    journal = Journal(tmp_path / "journal.jsonl")
    for entry in ENTRIES:
        journal.append(entry, durable=True)
    return journal.path


def test_reads_what_was_written(path: Path) -> None:
    assert [line.entry for line in read_journal(path).lines] == ENTRIES
    assert Journal(path).check == read_journal(path).lines[-1].check


def test_every_single_byte_flip_is_seen(path: Path) -> None:
    data = path.read_bytes()
    sound = read_journal(path).lines
    for place in range(len(data)):
        path.write_bytes(data[:place] + bytes([data[place] ^ 1 << place % 8]) + data[place + 1 :])
        try:
            assert read_journal(path).lines != sound
        except BadFile as error:
            assert "line" in str(error)


@pytest.mark.parametrize("lost", [1, 7, 60])
def test_a_torn_line_is_dropped_and_overwritten(path: Path, lost: int) -> None:
    whole = path.read_bytes()
    path.write_bytes(whole[:-lost])
    journal = Journal(path)
    assert journal.entries() == ENTRIES[:-1]
    journal.append(ENTRIES[-1], durable=False)
    assert path.read_bytes() == whole


@pytest.mark.parametrize("order", [[0, 2, 1, 3, 4], [0, 1, 3, 4], [1, 2, 3, 4]])
def test_moved_and_missing_lines_break_the_chain(path: Path, order: list[int]) -> None:
    lines = path.read_bytes().splitlines(keepends=True)
    path.write_bytes(b"".join(lines[n] for n in order))
    with pytest.raises(BadFile, match="checksum"):
        read_journal(path)
