"""Files of episode records: what is written is what is read, after a crash too."""

from pathlib import Path

import pytest
from evaluations import record

from rtphys.core.errors import BadFile
from rtphys.results.record_file import read_records, write_records


def test_a_record_is_what_was_written(tmp_path: Path) -> None:
    path = tmp_path / "clean" / "click_bell.jsonl"
    records = [
        record(1, first_touch=1.5, physics={"friction": None, "center_of_mass": [0.1, 0, 0]})
    ]
    records.append(record(2, success=False, detail='Traceback:\n  "x"'))
    write_records(path, records)
    assert read_records(path) == records
    write_records(path, records[:1])
    assert read_records(path) == records[:1]


def test_a_torn_last_line_is_passed_over(tmp_path: Path) -> None:
    """Earlier versions appended to the file; a crash could cut the last line short."""
    path = tmp_path / "click_bell.jsonl"
    write_records(path, [record(1)])
    whole = path.read_bytes()
    path.write_bytes(whole + whole[:40])
    assert read_records(path) == [record(1)]


def test_a_line_that_is_no_record_is_named(tmp_path: Path) -> None:
    path = tmp_path / "click_bell.jsonl"
    path.write_text('{"seed": 3}\n')
    with pytest.raises(BadFile, match="line 1: is no record"):
        read_records(path)
