"""One writer per dataset folder."""

import fcntl
import os
import socket
from pathlib import Path
from typing import IO, Self

from rtphys.data import files
from rtphys.data.faults import DatasetLocked
from rtphys.data.layout import LOCK


class FolderLock:
    """Held from construction to `release`, or to the end of its `with` block.

    The kernel frees it when its owner is killed. The file holds the owner's process id for the
    message alone: a number could be reused, a kernel lock cannot lie.
    """

    def __init__(self, out: Path) -> None:
        self.path = out / LOCK
        self._file = self._acquire(out)
        with files.refusals(self.path):
            self._file.truncate(0)
            self._file.write(f"process {os.getpid()} on {socket.gethostname()}")
            self._file.flush()

    def _acquire(self, out: Path) -> IO[str]:
        while True:
            with files.refusals(self.path):
                file = open(self.path, "a+", opener=files.unlinked)  # noqa: SIM115
            try:
                fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
            except OSError as error:
                file.seek(0)
                owner = file.read() or "unknown process"
                file.close()
                raise DatasetLocked(out, owner) from error
            # The last owner removes the file on release: a lock on a removed file guards nothing.
            if self.path.exists() and os.fstat(file.fileno()).st_ino == self.path.stat().st_ino:
                return file
            file.close()

    def release(self) -> None:
        """Idempotent."""
        if not self._file.closed:
            self.path.unlink(missing_ok=True)
            self._file.close()

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self.release()
