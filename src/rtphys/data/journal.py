"""The append-only record of a task dataset: one checksummed line per attempt.

Each line is `{"check": ..., "entry": ...}`; `check` is the SHA-256 of the previous check and this
entry, so a changed, lost or moved line breaks the chain. A line that a crash cut short is the only
damage that is expected, and it is dropped.
"""

import hashlib
import os
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

from rtphys.core.errors import BadFile
from rtphys.data import files
from rtphys.data.episode import JSON
from rtphys.data.faults import CannotWrite
from rtphys.data.json_text import compact, parse_mapping

START = "0" * 64


def link(previous: str, entry: JSON) -> str:
    """The check of an entry that follows one with check `previous`."""
    return hashlib.sha256(previous.encode() + compact(entry)).hexdigest()


@dataclass(frozen=True)
class Line:
    """One entry and the chain's check after it."""

    entry: Mapping[str, JSON]
    check: str


@dataclass(frozen=True)
class Contents:
    """All whole lines of a journal file."""

    lines: tuple[Line, ...]
    whole_bytes: int  # where the last whole line ends
    torn_bytes: int  # what a crash left after it


def read_journal(path: Path) -> Contents:
    """Reads and checks the chain.

    Raises:
        BadFile: unreadable, or a line other than a torn last one is damaged; names the line.
    """
    data = files.read(path)
    whole = data.rfind(b"\n") + 1
    lines: list[Line] = []
    previous = START
    for number, text in enumerate(data[:whole].split(b"\n")[:-1], start=1):
        line = _parse(text, previous, f"{path} line {number}")
        lines.append(line)
        previous = line.check
    return Contents(tuple(lines), whole, len(data) - whole)


def _parse(text: bytes, previous: str, where: str) -> Line:
    record = parse_mapping(text, where)
    entry, check = record.get("entry"), str(record.get("check"))
    # The text is compared too: a flipped byte may leave the same JSON value behind (1.0, 1e0).
    if not isinstance(entry, Mapping) or compact(record) != text or check != link(previous, entry):
        raise BadFile(where, "its checksum does not match: it was changed after it was written")
    return Line(entry, check)


class Journal:
    """An open journal. Nothing is written, no torn line cut off, before the first append.

    Entries are not kept in memory, which would grow with every attempt.
    """

    def __init__(self, path: Path) -> None:
        self.path = path
        self.count = 0
        self.check = START  # of the last entry
        self._torn_at: int | None = None
        if path.exists():
            contents = read_journal(path)
            self.count = len(contents.lines)
            self.check = contents.lines[-1].check if contents.lines else START
            self._torn_at = contents.whole_bytes if contents.torn_bytes else None

    def entries(self) -> list[Mapping[str, JSON]]:
        """Reads the file again. Raises `BadFile`."""
        return [line.entry for line in read_journal(self.path).lines] if self.count else []

    def check_there(self) -> None:
        """Raises `CannotWrite`: it had lines, and is gone, so what follows would have no start."""
        if self.count and not self.path.exists():
            problem = "it was removed while this run wrote into its folder"
            raise CannotWrite(self.path, OSError(problem))

    def append(self, entry: Mapping[str, JSON], *, durable: bool) -> None:
        """Adds one line. Raises `CannotWrite`, and then the file is as it was."""
        self.check_there()
        check = link(self.check, entry)
        text = compact({"check": check, "entry": entry}) + b"\n"
        with files.refusals(self.path):
            fresh = not self.path.exists()
            if self._torn_at is not None:
                os.truncate(self.path, self._torn_at)
                self._torn_at = None
            with open(self.path, "ab", opener=files.unlinked) as file:
                size = file.tell()
                try:
                    file.write(text)
                    file.flush()
                    if durable:
                        os.fsync(file.fileno())
                except OSError:
                    os.truncate(self.path, size)
                    raise
        if fresh:
            files.sync_folder(self.path.parent)
        self.count += 1
        self.check = check
