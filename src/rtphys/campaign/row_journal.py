"""Rows of a file in the making: a journal beside it, from the first row until the file is whole."""

from collections.abc import Mapping
from pathlib import Path

from rtphys.data.episode import JSON
from rtphys.data.files import make_folder
from rtphys.data.journal import Journal


class RowJournal:
    """One checksummed line a row, behind a first line that says under which conditions.

    The journal lies beside the file, hidden. `header` holds the conditions of all rows: compare it
    with `stored` before adding any. Raises `BadFile`: the journal is damaged.
    """

    def __init__(self, file: Path, header: Mapping[str, JSON]) -> None:
        make_folder(file.parent)
        self.path = file.parent / f".{file.stem}.journal"
        self._journal, self._header = Journal(self.path), header
        self.stored, *self.rows = self._journal.entries() or [header]

    def append(self, row: Mapping[str, JSON]) -> None:
        """Keeps a row. Raises `CannotWrite`."""
        for entry in (row,) if self._journal.count else (self._header, row):
            self._journal.append(entry, durable=True)

    def drop(self) -> None:
        """Called when the file holds all rows."""
        self.path.unlink(missing_ok=True)
