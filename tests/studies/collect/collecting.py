"""What the tests of `collect` share: a small plan, and what a folder holds."""

import hashlib
import os
import signal
from collections.abc import Callable, Sequence
from pathlib import Path

from rtphys.campaign.series import Listener, Progress
from rtphys.spec.collection import CollectionSpec
from rtphys.spec.episode import EpisodeSpec
from rtphys.spec.recording import RecordingSpec

# Small pictures: drawing them takes most of an episode's time.
PLAN = CollectionSpec(
    EpisodeSpec("click_bell", "phys_random"), RecordingSpec(size="160x120"), episodes=2
)


def complete(progresses: Sequence[Progress]) -> bool:
    """Whether every task dataset has its episodes."""
    return all(progress.done for progress in progresses)


def content(out: Path) -> dict[str, str]:
    """Path -> SHA-256 of every file, journals and manifest included."""
    files = (path for path in out.rglob("*") if path.is_file())
    return {
        path.relative_to(out).as_posix(): hashlib.sha256(path.read_bytes()).hexdigest()
        for path in files
    }


def worker_processes(pid: int | None = None) -> list[int]:
    """Worker processes below a process; below this one if none is named."""
    return processes("rtphys-worker", pid or os.getpid())


def kill_one(pids: Sequence[int]) -> bool:
    """Kills -9 the first of some processes, if there is one."""
    for pid in pids[:1]:
        os.kill(pid, signal.SIGKILL)
    return bool(pids)


class Striker(Listener):
    """Once an attempt is done, strikes as soon as it can; hears what is told of it.

    Args:
        strike: whether it did.
        early: do not wait for an attempt.
    """

    def __init__(self, strike: Callable[[], bool], early: bool = False) -> None:
        self.strike, self.begun, self.struck = strike, early, False
        self.told: list[str] = []
        self.progresses: Sequence[Progress] = []

    def started(self, progresses: Sequence[Progress]) -> None:
        self.progresses = progresses

    def ticked(self) -> None:
        self.begun |= any(progress.attempts for progress in self.progresses)
        self.struck = self.struck or (self.begun and self.strike())

    def noticed(self, text: str) -> None:
        self.told.append(text)


def processes(word: str, top: int | None = None) -> list[int]:
    """Processes below one whose name or command line holds a word."""
    parents: dict[int, int] = {}
    named: list[int] = []
    for folder in Path("/proc").glob("[0-9]*"):
        try:
            stat = (folder / "stat").read_text().rpartition(")")[2].split()
            name = (folder / "comm").read_text() + (folder / "cmdline").read_text()
        except OSError:
            continue
        parents[int(folder.name)] = int(stat[1])
        if word in name.replace("\0", " ") and stat[0] != "Z":
            named.append(int(folder.name))
    return [pid for pid in named if _is_below(pid, top or os.getpid(), parents)]


def _is_below(pid: int, top: int, parents: dict[int, int]) -> bool:
    while pid > 1:
        pid = parents.get(pid, 0)
        if pid == top:
            return True
    return False
