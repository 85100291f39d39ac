"""One writer per dataset folder."""

import errno
import fcntl
import os
import socket
from contextlib import suppress
from pathlib import Path
from typing import IO, Self

from rtphys.data import files
from rtphys.data.faults import CannotWrite, DatasetLocked
from rtphys.data.layout import HELD, LOCK

NO_LOCKS = (errno.ENOLCK, errno.ENOSYS, errno.EOPNOTSUPP)  # what a file system without them says
UNKNOWN = "unknown process"


class FolderLock:
    """Held from construction to `release`, or to the end of its `with` block.

    The kernel frees it when its owner is killed. The file holds the owner's process id for the
    message alone: a number could be reused, a kernel lock cannot lie. Where the file system has no
    locks, as Lustre often has not, a second file is the lock: who finds it there is refused.
    """

    def __init__(self, out: Path, at: Path | None = None) -> None:
        """`at`: the lock's file, if it must not lie in the folder.

        Raises:
            DatasetLocked: another run holds it.
            CannotWrite: no file can be made there, or it cannot be locked for another reason.
        """
        self.path = at or out / LOCK
        self._file = self._acquire(out)
        with files.refusals(self.path):
            self._file.truncate(0)
            self._file.write(f"process {os.getpid()} on {socket.gethostname()}")
            self._file.flush()

    def _acquire(self, out: Path) -> IO[str]:
        held = self.path.with_name(f"{self.path.name}{HELD}")
        while True:
            with files.refusals(self.path):
                file = open(self.path, "a+", opener=files.unlinked)  # noqa: SIM115
            try:
                fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
            except OSError as error:
                with file:
                    file.seek(0)
                    owner = file.read() or UNKNOWN
                if isinstance(error, BlockingIOError | PermissionError):  # of flock(2), of NFS
                    raise DatasetLocked(out, owner) from error
                if error.errno not in NO_LOCKS:
                    raise CannotWrite(self.path, error) from error
                if owner != UNKNOWN:  # of a machine that mounts the same folder with locks
                    raise DatasetLocked(out, owner, self.path) from error
                self.path.unlink(missing_ok=True)
                self.path = held
                try:
                    return open(held, "x", opener=files.unlinked)
                except FileExistsError as there:
                    raise DatasetLocked(out, _owner(held), held) from there
                except OSError as refused:
                    raise CannotWrite(held, refused) from refused
            if held.exists():
                file.close()
                raise DatasetLocked(out, _owner(held), held)
            # The last owner removes the file on release: a lock on a removed file guards nothing.
            if _leads_to(self.path, file):
                return file
            file.close()

    def release(self) -> None:
        """Idempotent."""
        if not self._file.closed:
            # Where somebody removed the folder, another run may hold the file of a new one.
            if _leads_to(self.path, self._file):
                self.path.unlink(missing_ok=True)
            self._file.close()

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self.release()


def _leads_to(path: Path, file: IO[str]) -> bool:
    """Whether a path still is that of an open file, which others may remove at any time."""
    try:
        return os.path.samestat(path.stat(), os.fstat(file.fileno()))
    except FileNotFoundError:
        return False


def _owner(path: Path) -> str:
    """Who wrote a file that is a lock, if it is still there."""
    with suppress(FileNotFoundError):
        return path.read_text() or UNKNOWN
    return UNKNOWN


def check_unlocked(out: Path) -> None:
    """For before the work that comes before the lock. Raises `DatasetLocked`."""
    if os.path.exists(out / LOCK):  # noqa: PTH110 - that of a path object may raise
        FolderLock(out).release()
