"""File of episode records (JSON Lines)."""

from collections.abc import Sequence
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


def write_records(path: Path, records: Sequence[EpisodeRecord]) -> None:
    """Replace the file by a rename. Raises `CannotWrite`."""
    files.make_folder(path.parent)
    files.replace_file(path, b"".join(compact(record.to_json()) + b"\n" for record in records))
