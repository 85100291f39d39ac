"""The work of a worker on another machine: checked to be the same work, its files sent back."""

import os
import platform
import shutil
import tempfile
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from pathlib import Path

from rtphys.assets.pack import chosen_pack
from rtphys.core.errors import RtphysError
from rtphys.data import files
from rtphys.data.conditions import differences
from rtphys.data.staging import StagedEpisode
from rtphys.episode.assemble import versions
from rtphys.studies.collect.plan import CollectPlan
from rtphys.studies.collect.work import Desk, Job, Result
from rtphys.task.spec import load_task

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

    def land(self, folder: Path) -> StagedEpisode:
        """Puts the files where a local worker would have.

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
class RemoteDesk:
    """As `Desk`, but nothing of the supervisor's disk is there, and nothing is believed."""

    desk: Desk  # its pack is the supervisor's
    assets: Path | None  # the pack that the plan names, at the same path on every node
    fallback: str
    digest: str  # of the supervisor's pack
    tasks: Mapping[str, Mapping[str, str]]  # task -> versions of all that shapes its episodes
    environment: Mapping[str, str]

    @staticmethod
    def of(plan: CollectPlan, desk: Desk) -> "RemoteDesk":
        known = {name: versions(load_task(name)) for name in plan.tasks}
        passed = {key: os.environ[key] for key in PASSED if key in os.environ}
        return RemoteDesk(desk, plan.assets, plan.fallback, desk.pack.digest, known, passed)

    def __call__(self) -> Callable[[Job], Sent]:
        """Raises `OtherMachine`. The builtin pack is built first if this node has none."""
        os.environ.update(self.environment)
        pack = chosen_pack(self.assets, self.fallback)
        if pack.digest != self.digest:
            told = f"its assets are {pack.digest[:12]}, the supervisor's {self.digest[:12]}"
            raise OtherMachine(f"{platform.node()}: {told}; link the same pack on both")
        for name, wanted in self.tasks.items():
            if found := differences(dict(wanted), dict(versions(load_task(name)))):
                raise OtherMachine(f"{platform.node()}: {name}: {'; '.join(found)}")
        folder = own_folder()
        do = replace(self.desk, pack=pack, tasks={})()

        def sent(job: Job) -> Sent:
            local = tuple(folder / str(n) for n in range(len(job.folders)))
            return tuple(_ship(one) for one in do(replace(job, folders=local)))

        return sent


def _ship(result: Result) -> Result | Shipped:
    if not isinstance(result, StagedEpisode):
        return result
    contents = {name: files.read(result.folder / name) for name in result.files}
    shutil.rmtree(result.folder, ignore_errors=True)
    return Shipped(result, contents)


def own_folder() -> Path:
    """A folder of this process; those of processes that have died are swept."""
    root = Path(tempfile.gettempdir()) / f"{ROOT}-{os.getuid()}-{platform.node()}"
    root.mkdir(mode=0o700, exist_ok=True)
    for old in root.iterdir():
        if not _alive(int(old.name)):
            shutil.rmtree(old, ignore_errors=True)
    folder = root / str(os.getpid())
    folder.mkdir(exist_ok=True)
    return folder


def _alive(pid: int) -> bool:
    try:
        os.kill(pid, 0)
    except ProcessLookupError:
        return False
    return True
