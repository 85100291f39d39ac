"""Checks the files of a dataset against its manifest, ledgers and seeds.

No simulator is needed: physics is sampled again from the seeds and the domains in the manifest. A
ledger is read line by line, so neither time nor memory grows faster than the dataset.
"""

import hashlib
import os
from collections.abc import Callable, Iterable, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, field
from functools import cache, cached_property
from importlib.metadata import version
from itertools import chain
from pathlib import Path
from typing import IO

from rtphys.assets.pack import pack_with
from rtphys.core.cache import NoCache, user_cache
from rtphys.core.errors import BadFile, counted
from rtphys.core.untrusted import JSON, check_inside, parse_mapping
from rtphys.data import files
from rtphys.data.attempts import (
    ATTEMPT,
    Accepted,
    KeptFailure,
    Rejected,
    Row,
    Totals,
    ledgers_below,
)
from rtphys.data.check_draws import DrawCheck
from rtphys.data.check_episode import Effort, Problem, check_episode
from rtphys.data.faults import CannotWrite, DatasetLocked
from rtphys.data.files import FileFacts
from rtphys.data.json_text import compact, pretty
from rtphys.data.layout import LEDGER, MANIFEST, STAGING, TaskDataset, episode_number
from rtphys.data.ledger import parse_row, read_header, read_lines
from rtphys.data.lock import check_unlocked
from rtphys.data.manifest import (
    LedgerState,
    Manifest,
    TaskEntry,
    dataset_digest,
    parse_manifest,
    read_bytes,
    task_entry,
)
from rtphys.data.writer import scene_pieces
from rtphys.physics import attributes
from rtphys.spec.collection import TaskHeader
from rtphys.spec.stored import differences, stored
from rtphys.spec.sweep import paired

CHECKS = "5"  # raised when a check is added or changed: old findings then count no more
CUT_OFF = "of a commit that was cut off; resuming removes it"
Progress = Callable[[int, int], None]  # episodes done, episodes in all


@dataclass
class Report:
    """Outcome of a verification; sound when there are no problems."""

    problems: list[Problem] = field(default_factory=list)
    notes: list[str] = field(default_factory=list)
    files: int = 0
    bytes: int = 0
    episodes: int = 0
    failures: int = 0  # attempts that failed and were kept
    digest: str = ""  # of the dataset: that of its manifest, which covers every ledger and file
    damaged: int = 0  # files that are not those which the ledgers list, or are missing
    newer: int = 0  # attempts that are in the folder, and not in the manifest nor the digest

    @property
    def sound(self) -> bool:
        return not self.problems

    def problem(self, path: Path, text: str) -> None:
        self.problems.append(Problem(path, text))


def default_path() -> Path | None:
    """In the user's cache folder; None where there is none."""
    try:
        return user_cache() / "verified.txt"
    except NoCache:
        return None


def verify(
    out: Path,
    effort: Effort = Effort.NORMAL,
    *,
    memory: Path | None = None,
    progress: Progress | None = None,
) -> Report:
    """Checks everything that needs no simulator.

    Args:
        out: the folder that holds `manifest.json`.
        effort: how much to look at; checksums, tables, labels and their physics always are.
        memory: file of digests that were found sound before, one a line, such as
            `verify.default_path()`. Checksums are computed every time; content with these
            checksums is not looked at again. All is, where the file cannot be read or written.
        progress: called with (episodes done, episodes in all), failures that were kept included.
    """
    report = Report()
    try:
        data = read_bytes(out)
        manifest = parse_manifest(data, out / MANIFEST)
    except BadFile as error:
        ledgers = chain(out.glob(f"*/*/*/{LEDGER}"), out.glob(f"*/*/{LEDGER}"))
        lost = not (out / MANIFEST).exists() and any(ledgers)
        return Report(problems=[Problem(error.path, error.problem)], damaged=int(lost))
    report.digest = dataset_digest(data)
    entries = manifest.task_datasets
    total = sum(entry.episodes + entry.failures for entry in entries.values())

    def looked_at() -> None:
        if progress:
            done = report.episodes + report.failures
            progress(done, max(total, done))

    remembered = set[str]()
    with suppress(OSError, UnicodeDecodeError):
        remembered = set(memory.read_text().split()) if memory else remembered
    checks: dict[str, _TaskCheck] = {}
    find_pack = cache(pack_with)  # for this call only: packs come and go
    for name, entry in entries.items():
        draws = DrawCheck(entry, find_pack)
        check = _TaskCheck(out, name, entry, draws, effort, remembered, report, looked_at)
        checks[name] = check
        try:
            check.run()
        except BadFile as error:
            report.problem(error.path, error.problem)
        report.newer += check.newer
        if memory and check.sound:
            with suppress(OSError):
                memory.parent.mkdir(parents=True, exist_ok=True)
                with memory.open("a") as file:  # one write: two runs at once tear no line
                    file.write("".join(f"{key}\n" for key in check.sound))
    _check_manifest(out, data, checks, report)
    _check_folder(out, manifest, report)
    return report


@dataclass
class _TaskCheck:
    """Walks one task dataset's ledger, and everything that it lists."""

    out: Path
    name: str
    entry: TaskEntry
    draws: DrawCheck
    effort: Effort
    remembered: set[str]  # digests of what was found sound before
    report: Report
    looked_at: Callable[[], None]  # called after every episode and every kept failure
    totals: Totals = field(default_factory=Totals)
    counted: TaskEntry | None = None  # what the manifest should say; None: no such line
    seeds: list[int] = field(default_factory=list)  # of the episodes
    failure_seeds: list[int] = field(default_factory=list)  # of the failures that were kept
    newer: int = 0
    sound: list[str] = field(default_factory=list)  # digests of what was found sound now

    @cached_property
    def place(self) -> TaskDataset:
        return self.entry.below(self.out)

    @cached_property
    def basis(self) -> list[JSON]:
        """Everything that a verdict depends on, except the episode."""
        task = self.draws.task.digest if self.draws.task else None  # without it less is compared
        here = [self.draws.gap, task, self.draws.pack is not None]
        code = [version("rtphys"), self.effort.name, *sorted(attributes())]
        return [CHECKS, stored(self.entry.header), code, here]

    def run(self) -> None:
        """Raises `BadFile`: the ledger or a folder cannot be read."""
        place, report = self.place, self.report
        if place.name != self.name:
            text = f"task dataset {self.name!r} does not lie where its task and config say"
            report.problem(self.out / MANIFEST, text)
            return
        place.check_links()
        if not place.ledger.exists():
            report.problem(place.ledger, "is missing: it lists every attempt and every file")
            return
        if self.draws.gap:
            report.notes.append(f"{self.name}: {self.draws.gap}")
        header = read_header(TaskHeader, place.ledger)
        if clauses := differences(stored(header), stored(self.entry.header)):
            text = f"{self.name} is not what its ledger says: {'; '.join(clauses)}"
            report.problem(self.out / MANIFEST, text)
        self._check_rows(header)
        if self.counted is None:
            report.problem(place.ledger, "has fewer lines than the manifest counted")
        if self.newer:
            text = f"the manifest lacks the last {counted(self.newer, 'attempts')}"
            report.notes.append(f"{self.name}: {text}; the run was cut off or still goes on")
        attempts = self.totals.attempts
        may_lag = bool(self.newer) or self.entry.listed < attempts or not attempts
        for one, seeds in ((place, self.seeds), (place.failures, self.failure_seeds)):
            if seeds or not one.failed:
                ends = (b"\n}\n", b"{}\n") if may_lag else ()
                self._check_side_file(one.scene_info, scene_pieces(one, []), ends)
                for path, end in ((one.seed_txt, " "), (one.seeds_txt, "\n")):
                    pieces = (f"{seed}{end}".encode() for seed in seeds)
                    self._check_side_file(path, pieces, (b"",) if may_lag else ())
        self._check_unlisted()

    def _check_rows(self, header: TaskHeader) -> None:
        """Every attempt; notes what the manifest should say of those that it counts."""
        path, spec, end = self.place.ledger, header.spec, 0
        size = path.stat().st_size
        for line in read_lines(path):
            row = None
            if line.number > 1:
                row = parse_row(ATTEMPT, line, path)
                with line.named(path):
                    self.totals.add(row)
            if line.number == self.entry.ledger.lines:
                state = LedgerState(line.number, line.end, line.check)
                self.counted = task_entry(header, self.totals, self.entry.listed, state)
            self.newer += line.number > self.entry.ledger.lines
            end = line.end
            if row is None:
                continue
            number = self.totals.attempts - 1
            if spec.made_by == "collect" and row.seed != (seed := spec.seed(number)):
                problem = f"attempt {number} is of seed {row.seed}, not of {seed}: one is missing"
                self.report.problem(path, problem)
            if row.on_disk is not None:
                failed = isinstance(row, Rejected)
                (self.failure_seeds if failed else self.seeds).append(row.seed)
                self.report.failures += failed
                self.report.episodes += not failed
                self._check_files(row, row.on_disk)
                self.looked_at()
        if end < size:
            text = "a crash cut its last line short; resuming drops it"
            self.report.notes.append(f"{path}: {text}")

    def _check_files(self, row: Row, held: Accepted | KeptFailure) -> None:
        report, paths, listed = self.report, held.paths(self.place), held.files
        wanted = {path.relative_to(self.place.folder).as_posix(): path for path in paths.all()}
        if listed.keys() != wanted.keys():
            problem = f"lists {sorted(listed)} for seed {row.seed}, not {sorted(wanted)}"
            report.problem(self.place.ledger, problem)
            return
        reasons = {
            path: file_problem(self.out, path, listed[name]) for name, path in wanted.items()
        }
        report.files += len(wanted)
        report.bytes += sum(facts.size for facts in listed.values())
        if wrong := [Problem(path, text) for path, text in reasons.items() if text]:
            report.problems += wrong  # what a damaged file holds is worth no second sentence
            report.damaged += len(wrong)
            return
        digests: list[JSON] = [listed[name].sha256 for name in wanted]
        about: list[JSON] = [*self.basis, digests, held.number, row.seed, row.verdict]
        key = hashlib.sha256(compact(about)).hexdigest()
        if key in self.remembered:
            return
        header, pack = self.entry.header, self.draws.pack
        meta, problems = check_episode(paths, header, row, self.effort, pack)
        if meta is not None:
            problems += [Problem(paths.phys_meta, text) for text in self.draws.problems(meta)]
        report.problems += problems
        if not problems:
            self.sound.append(key)

    def _check_side_file(self, path: Path, pieces: Iterable[bytes], ends: Sequence[bytes]) -> None:
        """`ends`: what may follow some of the pieces, where a run was cut off."""
        self.report.files += 1
        try:
            check_inside(self.out, path)
            with files.open_binary(path) as file:
                same = _holds(file, pieces, ends)
        except BadFile as error:
            if not (ends and not path.exists()):
                self.report.problem(path, error.problem)
                self.report.damaged += 1
            return
        self.report.bytes += path.stat().st_size
        if not same:
            self.report.problem(path, "is not what the ledger says")
            self.report.damaged += 1

    def _check_unlisted(self) -> None:
        """What lies in the folder that nothing lists."""
        report, place = self.report, self.place
        if place.staging.exists():
            report.notes.append(f"{self.name}: a run was cut off or still goes on ({STAGING})")
        known, folders = {place.ledger}, dict[Path, tuple[TaskDataset, int]]()
        for one, count in ((place, self.totals.episodes), (place.failures, self.totals.failures)):
            known |= {one.scene_info, one.seed_txt, one.seeds_txt}
            folders |= {path.parent: (one, count) for path in one.episode(0).all()}
        for folder, inner, names in os.walk(place.folder):
            if Path(folder) == place.folder and STAGING in inner:
                inner.remove(STAGING)
            of, count = folders.get(Path(folder), (place, -1))
            links = [name for name in inner if Path(folder, name).is_symlink()]  # are not followed
            for path in (Path(folder, name) for name in (*names, *links)):
                number = episode_number(path)
                listed = () if number is None or number >= count else of.episode(number).all()
                if path in known or path in listed:
                    continue
                if path.suffix == files.TEMPORARY or number == count:
                    report.notes.append(f"{path}: {CUT_OFF}")
                elif number is not None and number > count and _goes_on(self.out):
                    report.notes.append(f"{path}: newer than what was checked; a run goes on")
                else:
                    report.problem(path, "is in no manifest")


def file_problem(out: Path, path: Path, listed: FileFacts) -> str:
    """Why a file of a dataset in `out` is not the one that a ledger lists; empty: it is."""
    try:
        check_inside(out, path)
        if (size := path.stat().st_size) != listed.size:
            return f"has {size} bytes, not {listed.size}"
        if files.facts_of(path) != listed:
            return "its SHA-256 is not the listed one: the content was changed"
    except FileNotFoundError:
        return "is missing"
    except BadFile as error:
        return error.problem
    except OSError as error:
        return f"cannot be read ({error.strerror})"
    return ""


def _holds(file: IO[bytes], pieces: Iterable[bytes], ends: Sequence[bytes]) -> bool:
    """Whether a file holds these pieces, or the first of them and one of the ends."""
    for piece in pieces:
        if (found := file.read(len(piece))) != piece:
            longest = max(map(len, ends), default=0)
            return found + file.read(longest + 1) in ends
    return not file.read(1)


def _check_manifest(
    out: Path, data: bytes, checks: Mapping[str, _TaskCheck], report: Report
) -> None:
    """It must be what the ledgers say, at some earlier moment if a run was cut off; and twins."""
    path = out / MANIFEST
    for name, check in checks.items():
        if check.counted and check.counted.ledger.check != check.entry.ledger.check:
            report.problem(path, f"does not agree with the ledger of {name}")
    # Not byte for byte: fields that are newer than the dataset have their usual values.
    equal = all(check.counted == check.entry for check in checks.values())
    if report.sound and not (equal and pretty(parse_mapping(data, path)) == data):
        report.problem(
            path, "differs from what the ledgers say: it was changed after it was written"
        )
    names = {id(check.entry.spec): name for name, check in checks.items()}
    for group in paired([check.entry.spec for check in checks.values()]):
        first, *others = (names[id(spec)] for spec in group)
        missing = [TaskDataset.of(out, side).name for spec in group for side in spec.sides[1:]]
        for name in missing:
            if name not in checks:
                report.notes.append(f"{first}: its twin {name} is not here")
        seeds = checks[first].seeds
        for other in others:
            if any(a != b for a, b in zip(seeds, checks[other].seeds, strict=False)):
                report.problem(path, f"{first} and {other} pair other seeds")
            elif len(seeds) != len(checks[other].seeds):  # a run that was cut off leaves one ahead
                report.notes.append(f"{first}: some episodes are not in {other} yet; resume it")


def _goes_on(out: Path) -> bool:
    """Whether a run writes into a dataset now; one that was killed holds no lock."""
    try:
        check_unlocked(out)
    except DatasetLocked:
        return True
    except CannotWrite:
        return False
    return False


def _check_folder(out: Path, manifest: Manifest, report: Report) -> None:
    """Notes the task datasets that the manifest does not know yet."""
    try:
        for header in ledgers_below(out).values():
            name = TaskDataset.of(out, header.spec).name
            if name not in manifest.task_datasets:
                text = "was begun and is not in the manifest yet; resume it"
                report.notes.append(f"{name}: {text}")
    except BadFile as error:
        if error.path not in [problem.path for problem in report.problems]:
            report.problem(error.path, error.problem)
