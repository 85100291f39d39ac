"""`repair`: files of a dataset that are damaged or missing are made again."""

import tempfile
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import NamedTuple

from rtphys.campaign.local import run_here
from rtphys.campaign.pool import WorkerFailure
from rtphys.campaign.series import QUIET, Batch, Listener
from rtphys.core.errors import BadFile, RtphysError
from rtphys.data import files
from rtphys.data.attempts import Rejected, ledgers_below, read_attempts
from rtphys.data.check_episode import Problem
from rtphys.data.files import FileFacts
from rtphys.data.layout import MANIFEST, TaskDataset
from rtphys.data.lock import FolderLock, check_unlocked
from rtphys.data.manifest import read_manifest
from rtphys.data.verify import Progress, file_problem
from rtphys.data.writer import DatasetWriter, write_side_files
from rtphys.episode.reproduce import RecordedAttempt, changed_since, remade, scene_of
from rtphys.sim import renderer
from rtphys.studies.resources import check_drawable


class OtherVersions(RtphysError):
    """What would be made here is not what the dataset holds."""


class Damage(NamedTuple):
    """An attempt, and its files that are not what the ledger lists."""

    recorded: RecordedAttempt
    wanted: dict[Path, FileFacts]

    @property
    def shader(self) -> str:
        return self.recorded.header.spec.recording.shader


@dataclass
class Repaired:
    """What came of it."""

    files: list[Path] = field(default_factory=list[Path])  # made again
    problems: list[Problem] = field(default_factory=list[Problem])  # one each that was not


def repair(
    out: Path,
    damaged: Sequence[Damage],
    workers: int | None = None,
    listener: Listener = QUIET,
) -> Repaired:
    """Simulates what `damage` found again, and writes those files.

    Every file that is as its ledger lists it stays untouched. A new file is written only if it has
    the listed SHA-256. A manifest that is missing, and side files, are derived from the ledgers.

    Raises:
        BadFile: a ledger is damaged.
        OtherVersions: code, a package or the assets are others than in the collection.
        NoRenderer: no pictures can be drawn here.
        DatasetLocked: another run writes into the folder.
    """
    _check(damaged)
    with FolderLock(out):
        results = dict[int, list[Problem]]()
        for shader in sorted({one.shader for one in damaged}):  # a process draws with one
            jobs = {number: one for number, one in enumerate(damaged) if one.shader == shader}
            batch = Batch("repair", jobs, _lost)
            run_here([batch], RepairWorker(shader), workers, listener)
            results |= batch.results
        for ledger, header in ledgers_below(out).items():
            place = TaskDataset.of(out, header.spec)
            rows = (row for row in read_attempts(ledger) if isinstance(row, Rejected))
            write_side_files(place, any(row.kept for row in rows))
    done = Repaired()
    if not (out / MANIFEST).exists():
        with DatasetWriter(out):  # derives it from the ledgers
            done.files.append(out / MANIFEST)
    for number, problems in sorted(results.items()):
        refused = {problem.path for problem in problems}
        done.files += [path for path in damaged[number].wanted if path not in refused]
        done.problems += problems
    return done


def damage(out: Path, compared: Progress | None = None) -> list[Damage]:
    """Attempts with a file that is not what its ledger lists.

    `compared` is called with how many attempts' files were compared, and how many there are.

    Raises `BadFile`: a ledger or the manifest is damaged, or there is no dataset; `DatasetLocked`:
    another run writes there.
    """
    if not out.is_dir():
        raise BadFile(out, "there is no such folder")
    check_unlocked(out)
    there = ledgers_below(out)
    entries = read_manifest(out).task_datasets if (out / MANIFEST).exists() else {}
    for ledger in (entry.below(out).ledger for entry in entries.values()):
        if ledger not in there:
            raise BadFile(ledger, "is missing: nothing can be made again without it")
    if not there:
        raise BadFile(out, "holds no dataset")
    rows = [
        (header, row, row.on_disk.files)
        for ledger, header in there.items()
        for row in read_attempts(ledger)
        if row.on_disk is not None
    ]
    found = list[Damage]()
    for done, (header, row, listed) in enumerate(rows, start=1):
        recorded = RecordedAttempt(out, header, row)
        facts = {recorded.place.folder / name: one for name, one in listed.items()}
        wanted = {p: one for p, one in facts.items() if file_problem(out, p, one)}
        if compared:
            compared(done, len(rows))
        if wanted:
            found.append(Damage(recorded, wanted))
    return found


def _check(damaged: Sequence[Damage]) -> None:
    """Refuses what cannot come out as it was, once for each task dataset, before any work."""
    for recorded in {one.recorded.place.name: one.recorded for one in damaged}.values():
        if (policy := recorded.header.spec.policy) is not None:
            raise OtherVersions(
                f"{recorded.place.name} is a recording of the policy {policy}, which only "
                "`rtphys evaluate` makes again, with the option `record`"
            )
        if clauses := changed_since(scene_of(recorded, Path())):
            raise OtherVersions(
                f"{recorded.place.name} cannot be made again as it was: {'; '.join(clauses)}"
            )
    for shader in {one.shader for one in damaged}:
        check_drawable(shader=shader)


def _lost(job: Damage, loss: WorkerFailure) -> list[Problem]:
    return [Problem(path, str(loss)) for path in job.wanted]


@dataclass(frozen=True)
class RepairWorker:
    """Makes attempts again and writes those of their files that are wanted."""

    shader: str

    def __call__(self) -> Callable[[Damage], list[Problem]]:
        renderer.ready(self.shader)
        return self.do

    def do(self, job: Damage) -> list[Problem]:
        """What could not be written, and why."""
        with tempfile.TemporaryDirectory(prefix="rtphys-repair-") as folder:
            try:
                made = remade(job.recorded, Path(folder) / "episode")
            except RtphysError as error:
                return [Problem(path, str(error)) for path in job.wanted]
        found: list[Problem] = []
        for path, listed in job.wanted.items():
            if FileFacts.of(made[path]) == listed:
                files.make_folder(path.parent)
                files.replace_file(path, made[path])
            else:
                text = "made again it has other bytes than the ledger lists; pictures depend on "
                text += "device and driver, all files on the versions of packages"
                found.append(Problem(path, text))
        return found
