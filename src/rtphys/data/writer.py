"""A dataset folder open for writing: the lock, the task datasets, the manifest."""

import os
import shutil
import time
from collections.abc import Iterator, Mapping
from contextlib import suppress
from dataclasses import dataclass, field
from itertools import islice
from pathlib import Path
from typing import Any, Self, cast

from pydantic import JsonValue

from rtphys.core.errors import BadFile
from rtphys.data import files, staging
from rtphys.data.attempts import (
    ATTEMPT,
    Accepted,
    KeptFailure,
    Rejected,
    Totals,
    ledgers_below,
    read_attempts,
)
from rtphys.data.faults import CannotWrite, DatasetMismatch
from rtphys.data.files import replace_file
from rtphys.data.json_text import plain, pretty
from rtphys.data.layout import EPISODE_FOLDERS, MANIFEST, TaskDataset, episode_number
from rtphys.data.ledger import Ledger
from rtphys.data.lock import FolderLock
from rtphys.data.manifest import (
    LedgerState,
    TaskEntry,
    manifest_bytes,
    read_entry,
    read_manifest,
    task_entry,
)
from rtphys.data.staging import StagedEpisode
from rtphys.spec.collection import TaskHeader

CHECKPOINT_SECONDS = 20.0  # how far the manifest may lag behind the ledgers


@dataclass(frozen=True)
class Rejection:
    """An attempt that gave no episode. `reason` is counted, so it comes from a short list."""

    seed: int
    reason: str
    detail: str = ""  # deterministic text: it enters the ledger
    physics: Mapping[str, object] = field(default_factory=dict)  # value of what could act
    kept: StagedEpisode | None = None  # its files, which lie with the failures if there is room

    def row(self) -> Rejected:
        """Without its files. Raises `BadValue` where JSON cannot hold it."""
        physics = cast(dict[str, JsonValue], plain(self.physics, "physics"))
        return Rejected(seed=self.seed, reason=self.reason, detail=self.detail, physics=physics)


class TaskWriter:
    """Commits the outcomes of one task dataset in the order of the seeds, and numbers episodes.

    Raises:
        DatasetMismatch: what is there was collected otherwise; each field that differs is named.
        BadFile: its ledger is damaged, or a file that it lists is missing.
    """

    def __init__(self, out: Path, header: TaskHeader) -> None:
        self.task_dataset, self.header = TaskDataset.of(out, header.spec), header
        self.wanted = header.spec.episodes
        self._listed = 0  # attempts that the side files cover
        place = self.task_dataset
        place.check_links()
        self._read_ledger()
        leftovers = self._unlisted()
        if leftovers and not self._ledger.lines:  # somebody else's
            raise DatasetMismatch(place.folder, ["its episodes have no ledger"])
        shutil.rmtree(place.staging, ignore_errors=True)
        for path in leftovers:
            with files.refusals(path):
                path.unlink()
        for path in place.folder.rglob(f".*{files.TEMPORARY}"):
            if path.is_file():
                path.unlink()

    def _read_ledger(self) -> None:
        totals = Totals()
        ledger = Ledger(self.task_dataset.ledger, self.header, ATTEMPT, totals.add)
        self.totals, self._ledger = totals, ledger

    @property
    def next_seed(self) -> int:
        """The lowest seed whose outcome is not committed."""
        if self.header.spec.made_by == "collect":
            return self.header.spec.seed(self.totals.attempts)
        return self.totals.last_seed + 1

    @property
    def begun(self) -> bool:
        """Whether there is a ledger: not before the first attempt, or a checkpoint."""
        return self._ledger.lines > 0

    @property
    def done(self) -> bool:
        return self.totals.episodes >= self.wanted

    @property
    def wants_failures(self) -> bool:
        """Whether another failed attempt is kept: of what is copied, all that was."""
        spec = self.header.spec
        return spec.made_by != "collect" or self.totals.failures < spec.max_failures

    def seeds(self) -> Iterator[int]:
        """Those of the attempts that are there now; reads the ledger."""
        if there := self.totals.attempts:
            for row in islice(read_attempts(self.task_dataset.ledger), there):
                yield row.seed

    def staging(self, seed: int) -> Path:
        """Folder into which a worker stages the attempt of a seed, wherever a policy has gone."""
        return self.task_dataset.staging.absolute() / f"seed_{seed}"

    def discard(self, seed: int) -> None:
        """Removes what a worker has staged that is done, and that nobody will number."""
        shutil.rmtree(self.staging(seed), ignore_errors=True)

    def _unlisted(self) -> list[Path]:
        """Files of episodes and failures beyond those that the ledger lists: of a killed run.

        Raises `BadFile`: one that it lists is missing. What files hold is for `verify`.
        """
        found: list[Path] = []
        for place, count in (
            (self.task_dataset, self.totals.episodes),
            (self.task_dataset.failures, self.totals.failures),
        ):
            stems = [place.episode(number).stem for number in range(count)]
            ends = {path.parent: path.suffix for path in place.episode(0).all()}
            for folder in (place.folder / name for name in EPISODE_FOLDERS):
                there = set(os.listdir(folder)) if folder.is_dir() else set[str]()  # noqa: PTH208
                listed = {f"{stem}{ends[folder]}" for stem in stems if folder in ends}
                if missing := listed - there:
                    cure = "`repair` of `rtphys collect` makes it again"
                    problem = f"the ledger lists it, but it is missing; {cure}"
                    raise BadFile(folder / min(missing), problem)
                for path in (folder / name for name in sorted(there - listed)):
                    number = episode_number(path)
                    if number is not None and number >= count:
                        found.append(path)
        return found

    def record(self, outcome: StagedEpisode | Rejection) -> None:
        """Commits the outcome of `next_seed`.

        Raises:
            ValueError: it is another seed's.
            CannotWrite: the folder still is a valid prefix; the same run can be resumed.
        """
        later = self.header.spec.made_by != "collect" and outcome.seed > self.next_seed
        if outcome.seed != self.next_seed and not later:
            raise ValueError(f"the outcome of seed {outcome.seed} is not that of {self.next_seed}")
        self.begin()
        staged = outcome.kept if isinstance(outcome, Rejection) else outcome
        meta = cast(Mapping[str, Any], staged.phys_meta) if staged else {}
        row: Accepted | Rejected
        if isinstance(outcome, StagedEpisode):
            labels, number = meta["attributes"].items(), self.totals.episodes
            row = Accepted(
                seed=outcome.seed,
                episode=number,
                physics={key: label["value"] for key, label in labels if label["could_act"]},
                recovered=bool(meta["verdict"].get("recovered")),
                **self._placed(outcome, self.task_dataset, number),
            )
        else:
            row = outcome.row()
            if staged is not None and self.wants_failures:
                number, failure = self.totals.failures, meta["failure"]
                kept = KeptFailure(
                    number=number,
                    event=failure["event"],
                    time=failure["time"],
                    **self._placed(staged, self.task_dataset.failures, number),
                )
                row = row.model_copy(update={"kept": kept})
        try:
            self._ledger.append(row, durable=row.on_disk is not None)
            self.totals.add(row)
        except KeyboardInterrupt:  # the row may be written and not counted
            self._read_ledger()
            raise
        if staged is not None:
            shutil.rmtree(staged.folder, ignore_errors=True)

    def begin(self) -> None:
        """Begins the ledger if there is none. Raises `CannotWrite`: somebody has removed it."""
        self._ledger.start()
        self._ledger.check_there()

    def sync(self) -> None:
        """Waits until the disk has every attempt. Raises `CannotWrite`."""
        self._ledger.sync()

    def _placed(self, staged: StagedEpisode, place: TaskDataset, number: int) -> dict[str, Any]:
        """Moves files to where they belong: all, or none. Returns what `OnDisk` says of them."""
        meta = pretty({**staged.phys_meta, "episode": number})
        written = files.write_synced(staged.folder / staging.PHYS_META, meta)
        facts = {**staged.files, staging.PHYS_META: written}
        targets = staging.targets(place.episode(number))
        try:
            for name, target in targets.items():
                files.make_folder(target.parent)
                files.move(staged.folder / name, target)
        except CannotWrite:
            for target in targets.values():
                with suppress(OSError):
                    target.unlink()
            raise
        folder = self.task_dataset.folder
        listed = {
            path.relative_to(folder).as_posix(): facts[name] for name, path in targets.items()
        }
        return {"frames": staged.frames, "scene_info": staged.scene_info, "files": listed}

    def write_side_files(self, last: bool) -> None:
        """Once, when all is there, since it takes seconds; or when the run ends (`last`)."""
        if last or (self.done and self._listed < self.totals.attempts):
            write_side_files(self.task_dataset, self.totals.failures)
            self._listed = self.totals.attempts

    def entry(self) -> TaskEntry:
        """The task dataset's part of the manifest, which must not outlive a row that it counts."""
        self.sync()
        state = LedgerState(self._ledger.lines, self._ledger.end, self._ledger.check)
        return task_entry(self.header, self.totals, self._listed, state)


def write_side_files(place: TaskDataset, failures: int) -> None:
    """Derives seed.txt, seeds.txt and scene_info.json from the ledger. Raises `CannotWrite`."""
    for one in (place, place.failures) if failures else (place,):
        seeds: list[int] = []
        files.replace_pieces(one.scene_info, scene_pieces(one, seeds))
        for path, end in ((one.seed_txt, " "), (one.seeds_txt, "\n")):
            files.replace_file(path, "".join(f"{seed}{end}" for seed in seeds).encode())


def scene_pieces(place: TaskDataset, seeds: list[int]) -> Iterator[bytes]:
    """scene_info.json piece by piece, since a million scenes do not fit into memory.

    Args:
        place: of the episodes, or of the failures that were kept.
        seeds: gets the seed of each.
    """
    for row in read_attempts(place.ledger):
        if row.on_disk is not None and isinstance(row, Rejected) is place.failed:
            one = {f"episode_{len(seeds)}": row.on_disk.scene_info}
            text = pretty(one, ascii_only=place.layout == "legacy", indent=4, sort=False)
            yield (b",\n" if seeds else b"{\n") + text[2:-3]
            seeds.append(row.seed)
    yield b"\n}\n" if seeds else b"{}\n"


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
            CannotWrite: no file can be made there.
            DatasetLocked: another run writes there.
            BadFile: there is a `manifest.json` of another version, or that is no dataset's.
        """
        self.out = Path(out)
        self._tasks: dict[str, TaskWriter] = {}
        self._others: dict[str, TaskEntry] | None = None  # that this run does not write into
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

    def checkpoint(self, last: bool = False) -> None:
        """Writes side files and manifest of what the ledgers hold. Raises `CannotWrite`.

        Args:
            last: also those side files that are not due yet.
        """
        for writer in self._tasks.values():
            writer.begin()
            writer.write_side_files(last)
        if self._others is None:
            self._others = self._of_earlier_runs()
        entries = self._others | {name: writer.entry() for name, writer in self._tasks.items()}
        if entries:  # nothing: refused before any work, so leave nothing behind
            replace_file(self.out / MANIFEST, manifest_bytes(entries))
        self._saved = time.monotonic()

    def _of_earlier_runs(self) -> dict[str, TaskEntry]:
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

    def checkpoint_if_due(self) -> None:
        """Cheap enough to be called after every attempt."""
        if time.monotonic() - self._saved >= CHECKPOINT_SECONDS:
            self.checkpoint()

    def __enter__(self) -> Self:
        return self

    def __exit__(self, kind: object, error: object, trace: object) -> None:
        """Last checkpoint, then unlocks, also when it fails. Called when no worker runs."""
        # The first error is the one to show; a full disk also fails the last checkpoint.
        with suppress(*([CannotWrite] if error else [])):
            try:
                for writer in self._tasks.values():
                    shutil.rmtree(writer.task_dataset.staging, ignore_errors=True)
                if error:  # what was refused leaves nothing behind
                    self._tasks = {name: one for name, one in self._tasks.items() if one.begun}
                self.checkpoint(last=True)
            finally:
                self._lock.release()
