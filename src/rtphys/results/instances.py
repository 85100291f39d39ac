"""Certified lists: every seed that the expert tried, and whether it was feasible.

A file holds the lists of one protocol as JSON lines: for each task a header, then a row a seed.
"""

import json
from collections import Counter
from collections.abc import Iterable, Iterator
from dataclasses import dataclass, replace
from itertools import pairwise
from pathlib import Path
from typing import Annotated, Literal, NamedTuple

from pydantic import AfterValidator, Field, TypeAdapter

from rtphys.assets.embodiment import DEFAULT
from rtphys.core import library
from rtphys.core.bounds import LIST_BYTES
from rtphys.core.errors import BadFile
from rtphys.core.untrusted import JSON, read_file
from rtphys.data import files
from rtphys.data.json_text import Model
from rtphys.spec.stored import differences, problems_of

BENCHMARK = "benchmark_v3"
"""The folder below `manifests/` that holds this version's certified lists of tasks of no suite."""

FIRST_SEED = 100_000
"""First seed of certification, as in RoboTwin's evaluation; training seeds start at 0."""

ENFORCED = ("dataset", "task", "code", "robot")
"""Versions that decide an episode; other packages' are stored, and rarely matter."""

HASH_LENGTH = 16  # hexadecimal digits of a state hash that are stored
FORMAT = 2


class BenchmarkInstance(NamedTuple):
    """Certification of one seed; a row of a file. A replay that was not measured is None."""

    seed: Annotated[int, Field(strict=True)]
    reason: str = ""  # why the expert failed; empty for a feasible seed
    state: str = ""  # first `HASH_LENGTH` digits of the demonstration's state hash
    replay: Annotated[bool | None, Field(strict=True)] = None  # its actions succeed open loop
    twin: Annotated[bool | None, Field(strict=True)] = None  # those of the clean demonstration do

    @property
    def feasible(self) -> bool:
        return not self.reason


class DomainDigest(Model):
    """Name and digest of the rules that physics is drawn by."""

    name: str
    digest: str


class Fingerprint(Model):
    """Certification fingerprint: what decides which seeds are feasible.

    Equal fingerprints give equal lists.
    """

    domain: DomainDigest
    look: str  # digest of the protocol's visual rules; empty without any
    assets: str  # digest of the pack
    versions: Annotated[dict[str, str], AfterValidator(lambda found: dict(sorted(found.items())))]
    embodiment: str = DEFAULT

    def to_json(self) -> dict[str, JSON]:
        """As files hold it; the robot only where it is not the usual one."""
        return self.model_dump(mode="json", exclude_defaults=True)

    def changes(self, now: "Fingerprint") -> list[str]:
        """Why `evaluate` refuses a list with this fingerprint now: a clause for each difference.

        Versions that are not in `ENFORCED` may differ.
        """
        return differences(self._enforced(), now._enforced())

    def _enforced(self) -> dict[str, JSON]:
        versions = {key: self.versions.get(key) for key in ENFORCED}
        return {**self.model_dump(), "versions": versions}


@dataclass(frozen=True)
class InstanceList:
    """Certified seeds of one task under one protocol; consecutive, unless they are a dataset's."""

    task: str
    protocol: str
    fingerprint: Fingerprint
    instances: tuple[BenchmarkInstance, ...]
    replays: tuple[str, ...] = ()  # names of those that were measured
    # Of a dataset's seeds: the protocol under which the expert tried them, where it is another.
    tried_under: str = ""

    @property
    def first_seed(self) -> int:
        return self.instances[0].seed if self.instances else FIRST_SEED

    @property
    def feasible(self) -> tuple[BenchmarkInstance, ...]:
        return tuple(one for one in self.instances if one.feasible)

    @property
    def certified(self) -> bool:
        """Whether certification made it: then each feasible seed has its demonstration's state.

        The seeds of a dataset have none.
        """
        return all(one.state for one in self.feasible)

    @property
    def attempts(self) -> int:
        return len(self.instances)

    @property
    def rejected(self) -> Counter[str]:
        """Number of infeasible seeds by reason."""
        return Counter(one.reason for one in self.instances if not one.feasible)

    def first(self, episodes: int) -> "InstanceList":
        """The list up to its nth feasible seed: what an evaluation of n episodes uses."""
        ends = [n for n, one in enumerate(self.instances, start=1) if one.feasible]
        end = ends[episodes - 1] if episodes <= len(ends) else None
        return replace(self, instances=self.instances[:end])

    def begins(self, other: "InstanceList | None") -> bool:
        """Whether it is the first part of another list, or all of it."""
        return other is not None and other.first(len(self.feasible)) == self


class _Header(Model):
    """The line before a list's rows."""

    task: str
    protocol: str
    attempts: int  # number of rows
    feasible: int  # of these
    fingerprint: Fingerprint
    replays: list[str]
    columns: list[str]
    format: Literal[2]
    tried_under: str = ""


_ROW = TypeAdapter(BenchmarkInstance)


def list_file(folder: Path, protocol: str) -> Path:
    """Path of the lists of one protocol."""
    return folder / f"{protocol}.jsonl"


def lists_folder(root: Path, task: str) -> Path:
    """Where a library has the lists of a task: those of a suite are in a folder of its name."""
    path = library.find("tasks", task)
    suite = path.parent.relative_to(library.top_of("tasks", path)).name
    return root / "manifests" / (suite or BENCHMARK)


def benchmark_file(protocol: str, task: str) -> Path:
    """The lists of a protocol, this task's among them, that rtphys ships; may not be there."""
    return list_file(lists_folder(library.bundled(), task), protocol)


def write_lists(path: Path, lists: Iterable[InstanceList]) -> None:
    """Writes lists into a protocol's file, each in its task's place; other tasks' stay as they are.

    The file is replaced atomically. Equal lists give equal bytes. Raises `CannotWrite`: the file
    system refuses; `BadFile`: what is there is damaged, or would be larger than is read.
    """
    texts = {header.task: lines for _, header, lines in _parts(path)} if path.exists() else {}
    for one in lists:
        header = _Header(
            task=one.task,
            protocol=one.protocol,
            attempts=one.attempts,
            feasible=len(one.feasible),
            fingerprint=one.fingerprint,
            replays=list(one.replays),
            columns=list(BenchmarkInstance._fields),
            format=FORMAT,
            tried_under=one.tried_under,
        ).model_dump(mode="json", exclude_defaults=True)
        rows = [row if row.feasible else row[:2] for row in one.instances]
        texts[one.task] = [json.dumps(line).encode() for line in (header, *rows)]
    lines = (line + b"\n" for _, text in sorted(texts.items()) for line in text)
    if len(content := b"".join(lines)) > LIST_BYTES:
        problem = f"its lists would have {len(content) / 1e6:.1f} MB, more than is read"
        raise BadFile(path, f"{problem}; use another folder for some of the tasks")
    files.make_folder(path.parent)
    files.replace_file(path, content)


def read_list(path: Path, task: str) -> InstanceList | None:
    """The list of a task; None if the file has none of it.

    Raises `BadFile`: missing, of another format, a key is missing or has a wrong value, or seeds
    have gaps or contradict the header's counts.
    """
    return next((_read(*part) for part in _parts(path) if part[1].task == task), None)


def read_lists(path: Path) -> dict[str, InstanceList]:
    """All lists of a file, by task; errors are those of `read_list`."""
    return {part[1].task: _read(*part) for part in _parts(path)}


def read_fingerprints(path: Path) -> dict[str, Fingerprint]:
    """Fingerprints of the lists of a file by task, from their headers alone; fast.

    Raises `BadFile`: missing, or a header is damaged.
    """
    return {header.task: header.fingerprint for _, header, _ in _parts(path)}


def _parts(path: Path) -> Iterator[tuple[str, _Header, list[bytes]]]:
    """Where each list begins, its header, and its lines, the header's included."""
    *lines, torn = read_file(path, LIST_BYTES, links=True).split(b"\n")
    if torn:
        raise BadFile(path, "its last line is cut short; certify again")
    starts = [n for n, line in enumerate(lines) if line.startswith(b"{")]
    if lines and starts[:1] != [0]:
        raise BadFile(path, f"is no file of certified lists of format {FORMAT}")
    seen = set[str]()
    for start, end in pairwise([*starts, len(lines)]):
        where = f"{path} line {start + 1}"
        with problems_of(where):
            header = _Header.model_validate_json(lines[start])
        if header.task in seen:
            raise BadFile(where, f"is a second list of {header.task}")
        seen.add(header.task)
        yield where, header, lines[start:end]


def _read(where: str, head: _Header, lines: list[bytes]) -> InstanceList:
    if head.attempts != len(lines) - 1:
        raise BadFile(where, f"attempts are {head.attempts}, but it holds {len(lines) - 1} seeds")
    with problems_of(where):
        rows = tuple(_ROW.validate_json(line) for line in lines[1:])
    of = head.task, head.protocol, head.fingerprint
    found = InstanceList(*of, rows, tuple(head.replays), head.tried_under)
    steps = {after.seed - before.seed for before, after in pairwise(rows)}
    if min(steps, default=1) < 1 or (found.certified and max(steps, default=1) > 1):
        raise BadFile(where, "a seed is missing or occurs twice; certify it again")
    if head.feasible != len(found.feasible):
        raise BadFile(where, f"{head.feasible} are feasible, but it holds {len(found.feasible)}")
    return found
