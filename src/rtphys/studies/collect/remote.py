"""The work of a worker on another machine: checked to be the same work, its files sent back."""

import os
import platform
import shutil
import tempfile
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

from rtphys.core.errors import RtphysError
from rtphys.data import files
from rtphys.data.conditions import differences
from rtphys.data.staging import StagedEpisode
from rtphys.episode.assemble import versions
from rtphys.studies.collect.plan import Run
from rtphys.studies.collect.work import CollectWorker, Job, Result
from rtphys.task.spec import Task, load_task

ROOT = "rtphys-staging"  # below the folder for temporary files, with user and node
PASSED = ("RTPHYS_LIBRARY", "RTPHYS_ASSETS")  # paths that must mean the same on every node


class OtherMachine(RtphysError):
    """A node that would make other episodes."""

    exit_code = 3


@dataclass(frozen=True, eq=False)
class Shipped:
    """A result and the bytes of its files."""

    result: StagedEpisode
    contents: Mapping[str, bytes]

    @property
    def seed(self) -> int:
        return self.result.seed

    def land(self, folder: Path) -> StagedEpisode:
        """Writes the files where a local worker would have.

        Raises:
            CannotWrite: the disk refuses.
            OtherMachine: the bytes are not those that were sent.
        """
        shutil.rmtree(folder, ignore_errors=True)
        files.make_folder(folder)
        for name, data in self.contents.items():
            if files.write_synced(folder / name, data) != self.result.files[name]:
                raise OtherMachine(f"{folder / name}: it was damaged on its way here")
        return replace(self.result, folder=folder)


Sent = tuple[Result | Shipped, ...]
"""What comes of a job: a result for each recipe, from here or from elsewhere."""


@dataclass(frozen=True)
class RemoteWorker:
    """As `CollectWorker`, on a node that does not share the supervisor's disk; it checks all."""

    worker: CollectWorker  # its pack is the supervisor's
    run: Run  # names the pack, at the same path on every node
    digest: str  # of the supervisor's pack
    versions: Mapping[str, Mapping[str, str]]  # by task: all that shapes its episodes
    environment: Mapping[str, str]

    @staticmethod
    def of(worker: CollectWorker, run: Run, tasks: Sequence[Task]) -> "RemoteWorker":
        known = {task.name: versions(task) for task in tasks}
        passed = {key: os.environ[key] for key in PASSED if key in os.environ}
        return RemoteWorker(worker, run, worker.pack.digest, known, passed)

    def __call__(self) -> Callable[[Job], Sent]:
        """Raises `OtherMachine`. The builtin pack is built first if this node has none."""
        os.environ.update(self.environment)
        pack = self.run.pack()
        if pack.digest != self.digest:
            clause = f"its assets are {pack.digest[:12]}, the supervisor's {self.digest[:12]}"
            raise OtherMachine(f"{platform.node()}: {clause}; link the same pack on both")
        for name, wanted in self.versions.items():
            if clauses := differences(dict(wanted), dict(versions(load_task(name)))):
                raise OtherMachine(f"{platform.node()}: {name}: {'; '.join(clauses)}")
        folder = own_folder()
        do = replace(self.worker, pack=pack)()

        def do_and_ship(job: Job) -> Sent:
            local = tuple(folder / str(n) for n in range(len(job.folders)))
            return tuple(_ship(result) for result in do(replace(job, folders=local)))

        return do_and_ship


def _ship(result: Result) -> Result | Shipped:
    if not isinstance(result, StagedEpisode):
        return result
    contents = {name: files.read(result.folder / name) for name in result.files}
    shutil.rmtree(result.folder, ignore_errors=True)
    return Shipped(result, contents)


def own_folder() -> Path:
    """A folder of this process; removes those of processes that have died."""
    root = Path(tempfile.gettempdir()) / f"{ROOT}-{os.getuid()}-{platform.node()}"
    root.mkdir(mode=0o700, exist_ok=True)
    for old in root.iterdir():
        if not Path(f"/proc/{old.name}").exists():
            shutil.rmtree(old, ignore_errors=True)
    folder = root / str(os.getpid())
    folder.mkdir(exist_ok=True)
    return folder
