"""The log of a run: a first line with its spec, then one line an attempt, appended for ever.

A line is `CHECK JSON`, where CHECK is the SHA-256 of the check before and the bytes of the JSON. So
a changed, lost or moved line breaks the chain. A line that a crash cut short is the only damage
that is expected; it is dropped with the next append. Everything else that a run writes is derived
from its ledger, and made again from it after a kill.
"""

import hashlib
import os
import re
from collections.abc import Callable, Generator, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Generic, TypeVar

from pydantic import ValidationError

from rtphys.core.bounds import LINE_BYTES
from rtphys.core.errors import BadFile
from rtphys.core.untrusted import parse_mapping
from rtphys.data import files
from rtphys.data.faults import CannotWrite, DatasetMismatch
from rtphys.data.json_text import compact
from rtphys.spec.stored import SchemaError, adapter, differences, load, stored

H = TypeVar("H")
R = TypeVar("R")

START = "0" * 64  # the check before the first line
# What pydantic takes for a number, and JSON cannot hold; such lines are read more strictly, which
# takes twice as long. A digest is no number, though it may hold `3e123`.
SUSPECT = re.compile(rb"NaN|Infinity|[:,[]\s*-?([0-9.]+[eE]\+?[0-9]{3}|[0-9]{20})")


@dataclass(frozen=True)
class Line:
    """One whole line of a ledger."""

    number: int  # from 1; the first holds the spec
    check: str
    text: bytes  # JSON
    end: int  # [bytes] where it ends in the file

    @contextmanager
    def named(self, path: Path) -> Generator[None]:
        """Turns what the block finds wrong with the line into a `BadFile` that names it."""
        try:
            yield
        except (BadFile, ValueError) as error:
            problem = error.problem if isinstance(error, BadFile) else str(error)
            if isinstance(error, ValidationError):
                problem = "; ".join(SchemaError("", error).problems)
            raise BadFile(path, f"line {self.number}: {problem}") from error


def chained(previous: str, text: bytes) -> str:
    """The check of a line with this text behind one with check `previous`."""
    return hashlib.sha256(previous.encode() + text).hexdigest()


def read_lines(path: Path) -> Iterator[Line]:
    """Every whole line in order, its check verified; memory does not grow with the file.

    Raises `BadFile`: unreadable, or a line other than a torn last one is damaged; names the line.
    """
    check, end, number = START, 0, 0
    with files.open_binary(path) as file:
        while raw := file.readline(LINE_BYTES):
            number += 1
            if not raw.endswith(b"\n"):
                if len(raw) == LINE_BYTES:
                    raise BadFile(path, f"line {number}: is longer than {LINE_BYTES} bytes")
                return  # a crash cut it short
            stated, _, text = raw[:-1].partition(b" ")
            check, end = chained(check, text), end + len(raw)
            if stated != check.encode():
                problem = "its checksum does not match: it was changed after it was written"
                raise BadFile(path, f"line {number}: {problem}")
            yield Line(number, check, text, end)


def has_begun(path: Path) -> bool:
    """Whether the first line is there, which a kill may have cut short. Raises `BadFile`."""
    return next(read_lines(path), None) is not None


def read_header(kind: type[H], path: Path) -> H:
    """The spec in the first line. Raises `BadFile`: there is none, or it cannot be read."""
    for line in read_lines(path):
        return _header(kind, line, path)
    raise BadFile(path, "is empty: a run was killed before it began")


def _header(kind: type[H], line: Line, path: Path) -> H:
    with line.named(path):
        return load(kind, parse_mapping(line.text, path), path)


def read_rows(kind: type[R], path: Path) -> Iterator[R]:
    """Every row behind the first line. Raises `BadFile`, which names line and key."""
    return (parse_row(kind, line, path) for line in read_lines(path) if line.number > 1)


def parse_row(kind: type[R], line: Line, path: Path) -> R:
    """A line as a row. Raises `BadFile`, which names line and key."""
    with line.named(path):
        if SUSPECT.search(line.text):
            parse_mapping(line.text, path)
        return adapter(kind).validate_json(line.text)


class Ledger(Generic[H, R]):
    """A ledger open for appending. Nothing is written, no torn line cut off, before `start`.

    Args:
        header: the spec of the run, as a dataclass.
        row: type of a row: a dataclass, a pydantic model, or a union of them.
        restore: is given every row that is there already, in order; the file is read once. It may
            raise `ValueError` for one that cannot be.

    Raises:
        DatasetMismatch: the file was begun with another spec; names each field that differs.
        BadFile: it is damaged.
    """

    def __init__(
        self, path: Path, header: H, row: type[R], restore: Callable[[R], None] = lambda _: None
    ) -> None:
        self.path, self.header, self._row = path, header, row
        self.lines, self.end, self.check = 0, 0, START  # whole lines, their bytes, the last check
        self._synced = False
        if not (path.exists() or path.is_symlink()):
            return
        for line in read_lines(path):
            if line.number > 1:
                attempt = parse_row(row, line, path)
                with line.named(path):
                    restore(attempt)
            else:
                before = _header(type(header), line, path)
                if clauses := differences(stored(before), stored(header)):
                    raise DatasetMismatch(path.parent, clauses)
            self.lines, self.end, self.check = line.number, line.end, line.check

    def start(self) -> None:
        """Writes the first line if the file has none. Raises `CannotWrite`."""
        if not self.lines:
            files.make_folder(self.path.parent)
            self._write(compact(stored(self.header)), durable=True)
            files.sync_folder(self.path.parent)

    def append(self, row: R, *, durable: bool = True) -> None:
        """Adds one row. Raises `CannotWrite`, and then the file is as it was.

        Args:
            durable: wait until the disk has it. Without, a crash of the machine may lose the row,
                until `sync`.
        """
        self.start()
        self.check_there()
        self._write(compact(adapter(self._row).dump_python(row, mode="json")), durable=durable)

    def sync(self) -> None:
        """Waits until the disk has every row. Raises `CannotWrite`."""
        if not self._synced:
            with files.refusals(self.path), open(self.path, "rb", opener=files.unlinked) as file:
                os.fsync(file.fileno())
            self._synced = True

    def check_there(self) -> None:
        """Raises `CannotWrite`: the file is gone, so what follows would have no beginning."""
        if self.lines and not self.path.exists():
            problem = "it was removed while this run wrote into its folder"
            raise CannotWrite(self.path, OSError(problem))

    def _write(self, text: bytes, *, durable: bool) -> None:
        check = chained(self.check, text)
        line = check.encode() + b" " + text + b"\n"
        with (
            files.refusals(self.path),
            open(self.path, "ab", buffering=0, opener=files.unlinked) as file,
        ):
            if file.tell() != self.end:  # a torn line of a killed run
                file.truncate(self.end)
            try:
                rest = memoryview(line)
                while rest:  # a full disk takes a part, and says that it is full when asked again
                    rest = rest[file.write(rest) :]
                if durable:
                    os.fsync(file.fileno())
            except OSError:
                file.truncate(self.end)
                raise
        self.lines, self.end, self.check = self.lines + 1, self.end + len(line), check
        self._synced = durable
