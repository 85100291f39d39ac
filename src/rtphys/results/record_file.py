"""File of episode records (JSON Lines); a crash can only truncate its last line."""

import os
from pathlib import Path

from rtphys.data import files
from rtphys.data.json_text import compact, parse_mapping
from rtphys.results.record import EpisodeRecord


def read_records(path: Path) -> list[EpisodeRecord]:
    """Read every complete line; a truncated last line is skipped.

    Raises:
        BadFile: unreadable, or a complete line is no record.
    """
    data = files.read(path)
    lines = data[: data.rfind(b"\n") + 1].splitlines()
    return [
        EpisodeRecord.from_json(parse_mapping(line, f"{path} line {n}"), f"{path} line {n}")
        for n, line in enumerate(lines, start=1)
    ]


class RecordFile:
    """Appends records to a file; a truncated last line is removed before the next append."""

    def __init__(self, path: Path) -> None:
        self.path = path
        self.records = read_records(path) if path.exists() else []

    def append(self, record: EpisodeRecord) -> None:
        """Append a line and sync it to disk. Raises `CannotWrite`."""
        text = compact(record.to_json()) + b"\n"
        files.make_folder(self.path.parent)
        with files.refusals(self.path):
            if self.path.exists():
                os.truncate(self.path, self.path.read_bytes().rfind(b"\n") + 1)
            with self.path.open("ab") as file:
                file.write(text)
                file.flush()
                os.fsync(file.fileno())
        self.records.append(record)
