"""A dataset folder open for writing: the lock, the task datasets, the manifest."""

import shutil
import time
from contextlib import suppress
from pathlib import Path
from typing import Self

from rtphys.data import files
from rtphys.data.attempts import ledgers_below
from rtphys.data.faults import CannotWrite
from rtphys.data.files import replace_file
from rtphys.data.layout import MANIFEST, TaskDataset
from rtphys.data.lock import FolderLock
from rtphys.data.manifest import TaskEntry, manifest_bytes, read_entry, read_manifest
from rtphys.data.task_writer import TaskWriter, write_side_files
from rtphys.spec.collection import TaskHeader

CHECKPOINT_SECONDS = 20.0  # how far the manifest may lag behind the ledgers


class DatasetWriter:
    """Use as a context manager in the supervising process.

    At every instant the ledgers and the files they list are a valid dataset; the manifest is
    written at checkpoints and describes a prefix of it.

        with DatasetWriter(out) as dataset:
            task = dataset.task(header)
            while not task.done:
                seed = task.next_seed
                ...                                # in any process:
                staged = stage_episode(task.staging(seed), episode)
                task.record(staged)                # or task.record(Rejection(seed, reason))
                dataset.checkpoint_if_due()
    """

    def __init__(self, out: str | Path) -> None:
        """Locks the folder, making it if needed.

        Raises:
            CannotWrite, DatasetLocked,
            BadFile (there is a `manifest.json` of another version, or that is no dataset's).
        """
        self.out = Path(out)
        self._tasks: dict[str, TaskWriter] = {}
        self._others: dict[str, TaskEntry] | None = None
        self._saved = time.monotonic()
        files.make_folder(self.out)
        self._lock = FolderLock(self.out)
        try:
            there = (self.out / MANIFEST).exists()
            self._listed = read_manifest(self.out).task_datasets if there else {}
            self._there = ledgers_below(self.out)  # what others planted is refused before any work
        except BaseException:
            self._lock.release()
            raise

    def task(self, header: TaskHeader, wanted: int | None = None) -> TaskWriter:
        """Opens one task dataset, continuing what is there. Raises as `TaskWriter` does.

        Args:
            wanted: number of episodes; None: as the header says, if it was not read from a file,
                which does not hold it (`Extent`).
        """
        name = TaskDataset.of(self.out, header.spec).name
        if name not in self._tasks:
            self._tasks[name] = TaskWriter(self.out, header)
        writer = self._tasks[name]
        writer.wanted = header.spec.episodes if wanted is None else wanted
        return writer

    def _of_earlier_runs(self) -> dict[str, TaskEntry]:
        """Entries of the task datasets in the folder that this run does not write into."""
        found: dict[str, TaskEntry] = {}
        for path, header in self._there.items():
            place = TaskDataset.of(self.out, header.spec)
            if place.name in self._tasks or not path.exists():
                continue
            entry = self._listed.get(place.name)
            if entry is None or entry.ledger.bytes != path.stat().st_size:  # its run was killed
                entry = read_entry(place, header)
                write_side_files(place, entry.failures)
            found[place.name] = entry
        return found

    def checkpoint(self, last: bool = False) -> None:
        """Writes side files and manifest of what the ledgers hold. Raises `CannotWrite`.

        Args:
            last: also those side files that are not due yet.
        """
        for writer in self._tasks.values():
            writer.check_there()
            writer.write_side_files(last)
        if self._others is None:
            self._others = self._of_earlier_runs()
        entries = self._others | {name: writer.entry() for name, writer in self._tasks.items()}
        if entries:  # nothing: refused before any work, so leave nothing behind
            replace_file(self.out / MANIFEST, manifest_bytes(entries))
        self._saved = time.monotonic()

    def checkpoint_if_due(self) -> None:
        """Cheap enough to be called after every attempt."""
        if time.monotonic() - self._saved >= CHECKPOINT_SECONDS:
            self.checkpoint()

    def close(self) -> None:
        """Last checkpoint, then unlocks, also when it fails. Called when no worker runs."""
        try:
            for writer in self._tasks.values():
                shutil.rmtree(writer.task_dataset.staging, ignore_errors=True)
            self.checkpoint(last=True)
        finally:
            self._lock.release()

    def __enter__(self) -> Self:
        return self

    def __exit__(self, kind: object, error: object, trace: object) -> None:
        # The first error is the one to show; a full disk also fails the last checkpoint.
        with suppress(*([CannotWrite] if error else [])):
            self.close()
