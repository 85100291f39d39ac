"""Atomic writes: a reader sees the old file or the new one, nothing in between."""

import errno
import hashlib
import os
from collections.abc import Iterable, Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import IO

from rtphys.core.errors import BadFile
from rtphys.core.untrusted import hidden, open_ordinary, read_file
from rtphys.data.faults import CannotWrite
from rtphys.data.json_text import Count, Sha256
from rtphys.spec.option import checked_dataclass
from rtphys.spec.stored import CLOSED

TEMPORARY = ".part"  # suffix of files that are not finished


@checked_dataclass(frozen=True, config=CLOSED)  # a model would take twice as long to read
class FileFacts:
    """Size [bytes] and SHA-256 of a file, as a ledger states them."""

    size: Count
    sha256: Sha256

    @staticmethod
    def of(data: bytes) -> "FileFacts":
        return FileFacts(size=len(data), sha256=hashlib.sha256(data).hexdigest())


@contextmanager
def refusals(path: Path) -> Iterator[None]:
    """Turns an `OSError` of a write into `CannotWrite`, which names the cure."""
    try:
        yield
    except OSError as error:
        raise CannotWrite(path, error) from error


def make_folder(path: Path) -> None:
    """Raises `CannotWrite`."""
    with refusals(path):
        path.mkdir(parents=True, exist_ok=True)


def write_synced(path: Path, data: bytes) -> FileFacts:
    """Writes, syncs, reads back, compares. A failed write leaves no file. Raises `CannotWrite`."""
    with all_or_nothing(path):
        _write(path, (data,))
        if path.read_bytes() != data:  # a digest would take five times as long
            raise OSError("the disk returned other bytes than were written")
    return FileFacts.of(data)


def replace_file(path: Path, data: bytes) -> None:
    """Atomic: temporary name in the same folder, sync, rename, sync the folder."""
    temporary = hidden(path, TEMPORARY)
    write_synced(temporary, data)
    with all_or_nothing(temporary):  # a name may be refused, as one too long
        move(temporary, path)


def replace_pieces(path: Path, pieces: Iterable[bytes]) -> None:
    """As `replace_file`, for a content that need not fit into memory. Raises `CannotWrite`."""
    temporary = hidden(path, TEMPORARY)
    with all_or_nothing(temporary):
        _write(temporary, pieces)
        move(temporary, path)


@contextmanager
def all_or_nothing(path: Path) -> Iterator[None]:
    """Removes the file if the block fails. Raises `CannotWrite`."""
    try:
        with refusals(path):
            yield
    except BaseException:
        with suppress(OSError):
            path.unlink()
        raise


def _write(path: Path, pieces: Iterable[bytes]) -> None:
    path.unlink(missing_ok=True)  # of a killed run; or a link, which must not be followed
    with path.open("xb") as file:
        file.writelines(pieces)
        file.flush()
        os.fsync(file.fileno())


def move(source: Path, target: Path) -> None:
    """Atomic and durable rename on one file system. Raises `CannotWrite`."""
    with refusals(target):
        source.replace(target)
    sync_folder(target.parent)


def sync_folder(folder: Path) -> None:
    """Makes renames in a folder durable. Raises `CannotWrite`."""
    with refusals(folder):
        handle = os.open(folder, os.O_RDONLY)
        try:
            os.fsync(handle)
        except OSError as error:
            if error.errno != errno.EINVAL:  # a file system that syncs no folders, as some AFS
                raise
        finally:
            os.close(handle)


read = read_file


def open_binary(path: Path) -> IO[bytes]:
    """An ordinary file, to be read in pieces. Raises `BadFile`, as `read` does."""
    try:
        return os.fdopen(open_ordinary(path), "rb")
    except OSError as error:
        raise BadFile(path, (error.strerror or "cannot be read").lower()) from error


def facts_of(path: Path) -> FileFacts:
    """Reads the whole file once. Raises `OSError`, or `BadFile`: a link, or no ordinary file."""
    with os.fdopen(open_ordinary(path), "rb", buffering=0) as file:
        digest = hashlib.file_digest(file, "sha256")
        return FileFacts(size=file.tell(), sha256=digest.hexdigest())


def unlinked(path: str, flags: int) -> int:
    """Opener for `open`: refuses a link instead of writing where it leads."""
    return os.open(path, flags | os.O_NOFOLLOW | os.O_CLOEXEC, 0o666)
