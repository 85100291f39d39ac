"""Attempts of a dataset are made again: a sample to be compared, or files that are damaged."""

import os
import tempfile
from collections import defaultdict
from collections.abc import Callable, Iterator, Sequence
from contextlib import suppress
from dataclasses import dataclass, field
from functools import partial
from heapq import heappop, heappush
from operator import itemgetter
from pathlib import Path
from typing import NamedTuple

from rtphys.campaign.local import run_here
from rtphys.campaign.pool import LOSSES, WorkerFailure
from rtphys.campaign.series import QUIET, Batch, Listener
from rtphys.core.errors import BadFile, NoRenderer, RtphysError, counted
from rtphys.core.seeds import stream
from rtphys.data import files
from rtphys.data.attempts import Accepted, Rejected, ledgers_below, read_attempts
from rtphys.data.check_episode import Problem
from rtphys.data.compare import Comparison
from rtphys.data.files import FileFacts
from rtphys.data.layout import MANIFEST, TaskDataset
from rtphys.data.lock import FolderLock, check_unlocked
from rtphys.data.manifest import Manifest, read_manifest
from rtphys.data.verify import Progress, file_problem
from rtphys.data.writer import DatasetWriter, write_side_files
from rtphys.episode.reproduce import RecordedAttempt, changed_since, remade, reproduce, scene_of
from rtphys.sim import renderer
from rtphys.spec.collection import TaskHeader
from rtphys.spec.sweep import paired, values_of
from rtphys.studies.resources import check_drawable

# ---- a sample is compared ------------------------------------------------------------------------


@dataclass
class Reproduction:
    """What came of it; `notes` name what could not be compared to the last bit, and why."""

    problems: list[Problem] = field(default_factory=list[Problem])
    notes: list[str] = field(default_factory=list[str])
    episodes: list[str] = field(default_factory=list[str])  # made again
    rejections: list[str] = field(default_factory=list[str])  # tried again

    def judge(self, attempts: Sequence[RecordedAttempt], found: Sequence[Comparison]) -> None:
        """Adds what was found of each attempt.

        What is alike is a fault if other things of its kind are equal to the last bit.
        """
        exact = set[str]().union(*(one.exact for one in found))
        for attempt, comparison in zip(attempts, found, strict=True):
            if comparison.made:
                accepted = isinstance(attempt.row, Accepted)
                (self.episodes if accepted else self.rejections).append(attempt.name)
            self.problems += [Problem(path, text) for path, text in comparison.problems]
            self.notes += [note for note in comparison.notes if note not in self.notes]
            for kind, path, text in comparison.alike:
                if kind in exact:
                    same = f"{text}; other {kind} here are equal to the last bit"
                    self.problems.append(Problem(path, same))
                else:
                    other = "drawn or encoded by another program, by `convert`, or changed a little"
                    self.notes.append(f"{path}: {text}: {other}")


def reproduced(
    out: Path, count: int, workers: int | None = None, listener: Listener = QUIET
) -> Reproduction:
    """Makes a sample of episodes and of rejected seeds again, all of them if `count` is as large.

    Raises `BadFile`: there is no manifest; `Bug`: an unexpected exception in a worker.
    """
    found = Reproduction()
    # A random sample that nobody could know when the dataset was made. All do not fit into memory.
    rng = stream(int.from_bytes(os.urandom(7)), "reproduce")
    picks: dict[bool, list[tuple[float, int, RecordedAttempt]]] = {True: [], False: []}
    for number, attempt in enumerate(recorded_attempts(out, read_manifest(out), found)):
        of_kind = picks[isinstance(attempt.row, Accepted)]
        heappush(of_kind, (rng.random(), number, attempt))
        if len(of_kind) > count:
            heappop(of_kind)
    attempts = [pick[2] for kind in picks.values() for pick in sorted(kind, key=itemgetter(1))]
    results = dict[int, Comparison]()
    for shader, numbers in by_shader(attempts).items():
        batch = Batch("reproduce", {number: attempts[number] for number in numbers}, lost)
        run_here([batch], partial(reproducer, shader), workers, listener)
        results |= batch.results
    found.judge(attempts, [results[number] for number in range(len(attempts))])
    return found


def recorded_attempts(
    out: Path, manifest: Manifest, found: Reproduction
) -> Iterator[RecordedAttempt]:
    """What the dataset says of each seed; what cannot be read is a problem of the reproduction."""
    entries = manifest.task_datasets
    headers = {TaskDataset.of(out, entry.spec).name: entry.header for entry in entries.values()}
    others = dict[str, list[TaskHeader]]()
    for group in paired([entry.spec for entry in entries.values()]):
        names = [TaskDataset.of(out, spec).name for spec in group]
        others |= {name: [headers[one] for one in names if one != name] for name in names}
    for name, entry in entries.items():
        if (policy := entry.spec.policy) is not None:
            found.notes.append(f"{name}: what {policy} did cannot be made again without it")
            continue
        beside, spec, left = tuple(others.get(name, ())), entry.spec, 0
        values = len(values_of(spec.sweep)[1]) if spec.sweep else 1
        whole = len(beside) + 1 == values * (2 if spec.twin or spec.twin_of else 1)
        try:
            for row in entry.rows(out):
                if not whole and isinstance(row, Rejected) and row.reason == "unpaired":
                    left += 1
                    continue
                yield RecordedAttempt(out, entry.header, row, beside)
        except BadFile as error:
            text = f"{name} cannot be made again: {error.problem}"
            found.problems.append(Problem(error.path, text))
        if left:
            text = f"{counted(left, 'seeds')} cannot be tried again without all twins and values"
            found.notes.append(f"{name}: {text} that they had to succeed with too")


def by_shader(attempts: Sequence[RecordedAttempt]) -> dict[str, list[int]]:
    """Shader -> numbers of the attempts that it drew: a process draws with one."""
    found = defaultdict[str, list[int]](list)
    for number, attempt in enumerate(attempts):
        found[attempt.header.spec.recording.shader].append(number)
    return found


def lost(attempt: RecordedAttempt, loss: WorkerFailure) -> Comparison:
    """What comes of an attempt that took its workers with it."""
    if isinstance(attempt.row, Rejected) and attempt.row.reason in LOSSES:  # as when collected
        return Comparison(made=False)
    return Comparison([(attempt.place.ledger, f"{attempt.name}: {loss}")], made=False)


def reproducer(shader: str) -> Callable[[RecordedAttempt], Comparison]:
    """A worker that makes attempts again, and draws them where this machine can."""
    with suppress(NoRenderer):
        renderer.ready(shader)

    def compared(attempt: RecordedAttempt) -> Comparison:
        with tempfile.TemporaryDirectory(prefix="rtphys-reproduce-") as folder:
            return reproduce(attempt, Path(folder) / "episode")

    return compared


# ---- damaged and missing files are written -------------------------------------------------------


class Damage(NamedTuple):
    """An attempt, and its files that are not what the ledger lists."""

    recorded: RecordedAttempt
    wanted: dict[Path, FileFacts]


@dataclass
class Repaired:
    """What came of it."""

    files: list[Path] = field(default_factory=list[Path])  # made again
    problems: list[Problem] = field(default_factory=list[Problem])  # one each that was not


def repair(
    out: Path, damaged: Sequence[Damage], workers: int | None = None, listener: Listener = QUIET
) -> Repaired:
    """Simulates what `damage` found again, and writes those files.

    Every file that is as its ledger lists it stays untouched. A new file is written only if it has
    the listed SHA-256. A manifest that is missing, and side files, are derived from the ledgers.

    Raises:
        BadFile: a ledger is damaged.
        RtphysError: code, a package or the assets are others than in the collection.
        NoRenderer: no pictures can be drawn here.
        DatasetLocked: another run writes into the folder.
    """
    drawn_with = by_shader([one.recorded for one in damaged])
    _check(damaged)
    for shader in drawn_with:
        check_drawable(shader=shader)
    with FolderLock(out):
        results = dict[int, list[Problem]]()
        for shader, numbers in drawn_with.items():
            jobs = {number: damaged[number] for number in numbers}
            batch = Batch("repair", jobs, lambda job, loss: _unwritten(job, str(loss)))
            run_here([batch], partial(repairer, shader), workers, listener)
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

    def on_disk() -> Iterator[tuple[RecordedAttempt, dict[str, FileFacts]]]:
        for ledger, header in there.items():
            for row in read_attempts(ledger):
                if row.on_disk is not None:
                    yield RecordedAttempt(out, header, row), row.on_disk.files

    found = list[Damage]()
    total = sum(1 for _ in on_disk())  # all rows do not fit into memory
    for done, (recorded, listed) in enumerate(on_disk(), start=1):
        facts = {recorded.place.folder / name: one for name, one in listed.items()}
        wanted = {p: one for p, one in facts.items() if file_problem(out, p, one)}
        if compared:
            compared(done, total)
        if wanted:
            found.append(Damage(recorded, wanted))
    return found


def _check(damaged: Sequence[Damage]) -> None:
    """Refuses what cannot come out as it was, once for each task dataset, before any work."""
    for recorded in {one.recorded.place.name: one.recorded for one in damaged}.values():
        if (policy := recorded.header.spec.policy) is not None:
            raise RtphysError(
                f"{recorded.place.name} is a recording of the policy {policy}, which only "
                "`rtphys evaluate` makes again, with the option `record`"
            )
        if clauses := changed_since(scene_of(recorded, Path())):
            raise RtphysError(
                f"{recorded.place.name} cannot be made again as it was: {'; '.join(clauses)}"
            )


def _unwritten(job: Damage, why: str) -> list[Problem]:
    return [Problem(path, why) for path in job.wanted]


def repairer(shader: str) -> Callable[[Damage], list[Problem]]:
    """A worker that makes attempts again and writes those of their files that are wanted."""
    renderer.ready(shader)
    return _mend


def _mend(job: Damage) -> list[Problem]:
    """What could not be written, and why."""
    with tempfile.TemporaryDirectory(prefix="rtphys-repair-") as folder:
        try:
            made = remade(job.recorded, Path(folder) / "episode")
        except RtphysError as error:
            return _unwritten(job, str(error))
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
