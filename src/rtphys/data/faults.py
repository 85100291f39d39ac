"""Errors of a dataset folder; each class writes its own sentence."""

import errno
from pathlib import Path

from rtphys.core.errors import RtphysError

OTHER_SEEDS = "its seeds are not those that are asked for"
_RIGHT = "permission denied; give this user the right to write there, or choose another folder"
CAUSES = {
    errno.ENOSPC: "the disk is full; free some space, then repeat the command",
    errno.EDQUOT: "the disk quota is used up; free some space, then repeat the command",
    errno.EROFS: "the file system is read-only; choose another folder",
    errno.EACCES: _RIGHT,
    errno.EPERM: _RIGHT,
    errno.ENOTDIR: "a file stands where a folder is needed; choose another folder",
    errno.EEXIST: "a file stands where a folder is needed; choose another folder",
}


class CannotWrite(RtphysError):
    """The file system refused a write: full, read-only, no permission."""

    def __init__(self, path: str | Path, cause: OSError) -> None:
        self.path, self.errno = Path(path), cause.errno
        text = CAUSES.get(cause.errno or 0, cause.strerror or str(cause))
        super().__init__(f"cannot write {path}: {text}")


class DatasetLocked(RtphysError):
    """Another run writes into this folder."""

    def __init__(self, out: str | Path, owner: str, stale: Path | None = None) -> None:
        """`stale`: a file that stays when its owner is killed, where there are no real locks."""
        cure = "wait, stop it, or choose another folder"
        if stale is not None:
            cure += f"; if it was killed, delete {stale}: this file system has no locks"
        super().__init__(f"{out}: another run writes here ({owner}); {cure}")


class DatasetMismatch(RtphysError):
    """What is there was made by a run with another spec, so it cannot be continued."""

    def __init__(self, folder: str | Path, differences: list[str]) -> None:
        super().__init__(
            f"{folder}: holds the work of another run and cannot be continued: "
            f"{'; '.join(differences)}. Choose another folder or ask for the same again"
        )


class PartsMismatch(RtphysError):
    """Datasets that cannot be joined to one."""

    def __init__(self, part: str | Path, differences: list[str]) -> None:
        super().__init__(f"{part}: cannot be joined with the others: {'; '.join(differences)}")


class BadEpisode(RtphysError):
    """An episode whose arrays contradict each other; nothing was written."""

    def __init__(self, problems: list[str]) -> None:
        super().__init__(f"the episode cannot be stored: {'; '.join(problems)}")
