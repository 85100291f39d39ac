"""Rows of a file in the making survive whatever happens before the file is whole."""

from pathlib import Path

import pytest

from rtphys.campaign.row_journal import RowJournal
from rtphys.core.errors import BadFile

HEADER = {"task": "lift_pot", "first_seed": 7}


def journal(tmp_path: Path, header: dict = HEADER) -> RowJournal:
    return RowJournal(tmp_path / "clean" / "lift_pot.yaml", header)


def test_rows_are_found_again_behind_their_header(tmp_path: Path) -> None:
    made = journal(tmp_path)
    assert (made.rows, made.stored) == ([], HEADER)
    for seed in range(3):
        made.append({"seed": seed})
    again = journal(tmp_path, {"task": "another"})
    assert again.rows == [{"seed": 0}, {"seed": 1}, {"seed": 2}]
    assert again.stored == HEADER, "what it was begun with, to be compared"
    again.append({"seed": 3})
    assert [row["seed"] for row in journal(tmp_path).rows] == [0, 1, 2, 3]


def test_nothing_is_written_before_the_first_row(tmp_path: Path) -> None:
    made = journal(tmp_path)
    assert not made.path.exists()
    made.append({"seed": 0})
    assert made.path == tmp_path / "clean" / ".lift_pot.journal"
    assert made.path.exists()


def test_a_torn_row_is_forgotten_and_written_over(tmp_path: Path) -> None:
    made = journal(tmp_path)
    made.append({"seed": 0})
    made.append({"seed": 1})
    made.path.write_bytes(made.path.read_bytes()[:-7])
    again = journal(tmp_path)
    assert again.rows == [{"seed": 0}]
    again.append({"seed": 9})
    assert journal(tmp_path).rows == [{"seed": 0}, {"seed": 9}]


def test_a_torn_header_is_no_header(tmp_path: Path) -> None:
    made = journal(tmp_path)
    made.append({"seed": 0})
    first = made.path.read_bytes().splitlines()[0]
    made.path.write_bytes(first[:-3])
    again = journal(tmp_path, {"task": "another"})
    assert (again.rows, again.stored) == ([], {"task": "another"})


def test_a_changed_row_is_refused(tmp_path: Path) -> None:
    made = journal(tmp_path)
    made.append({"seed": 0})
    made.append({"seed": 1})
    made.path.write_bytes(made.path.read_bytes().replace(b'"seed":0', b'"seed":5'))
    with pytest.raises(BadFile, match=r"\.lift_pot\.journal line 2: its checksum does not match"):
        journal(tmp_path)


def test_it_is_dropped_when_the_file_is_whole(tmp_path: Path) -> None:
    made = journal(tmp_path)
    made.append({"seed": 0})
    made.drop()
    made.drop()
    assert journal(tmp_path).rows == []
