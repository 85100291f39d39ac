"""`manifest.json`: what each task dataset is and adds up to, and the state of its ledger.

It is derived from the ledgers, which list every attempt and every file with its SHA-256. It holds
the last check of each ledger's chain, so its digest covers them all, and it stays small.
"""

import os
from collections.abc import Iterator, Mapping
from itertools import islice
from pathlib import Path

from rtphys.core.errors import BadFile, shortened
from rtphys.core.untrusted import parse_mapping
from rtphys.data import files
from rtphys.data.attempts import ATTEMPT, Row, Totals, read_attempts
from rtphys.data.files import FileFacts
from rtphys.data.json_text import Count, pretty
from rtphys.data.layout import LEDGER, MANIFEST, TaskDataset
from rtphys.data.ledger import Ledger
from rtphys.spec.collection import DATASET_VERSION, CollectionSpec, Resolved, TaskHeader
from rtphys.spec.option import checked_dataclass
from rtphys.spec.stored import CLOSED, load, stored


@checked_dataclass(frozen=True, config=CLOSED)
class LedgerState:
    """How far a ledger had come when the manifest was written."""

    lines: Count
    bytes: Count
    check: str  # of the last of these lines


@checked_dataclass(frozen=True, config=CLOSED)
class TaskEntry:
    """One task dataset."""

    spec: CollectionSpec
    resolved: Resolved
    episodes: Count
    frames: Count
    attempts: Count
    failures: Count  # failed attempts whose files are kept
    recovered: Count  # episodes in which a load was lost and taken again
    rejections: Mapping[str, Count]  # by reason
    could_act: tuple[str, ...]  # attributes that could in some attempt
    listed: Count  # attempts that the side files cover; all, once it is done
    ledger: LedgerState

    @property
    def header(self) -> TaskHeader:
        """As in the first line of its ledger."""
        return TaskHeader(self.spec, self.resolved)

    def below(self, out: Path) -> TaskDataset:
        """Where its files lie when the manifest lies in `out`."""
        return TaskDataset.of(out, self.spec)

    def rows(self, out: Path) -> Iterator[Row]:
        """Its attempts in order, as far as the manifest in `out` counts them. Raises `BadFile`.

        A run that is going on, or was killed, has more of them in the ledger.
        """
        return islice(read_attempts(self.below(out).ledger), self.attempts)


@checked_dataclass(frozen=True, config=CLOSED)
class Manifest:
    """`manifest.json`."""

    dataset_version: str
    task_datasets: Mapping[str, TaskEntry]  # by folder below the manifest


def task_entry(header: TaskHeader, totals: Totals, listed: int, ledger: LedgerState) -> TaskEntry:
    """A task dataset's part of the manifest."""
    return TaskEntry(
        spec=header.spec,
        resolved=header.resolved,
        episodes=totals.episodes,
        frames=totals.frames,
        attempts=totals.attempts,
        failures=totals.failures,
        recovered=totals.recovered,
        rejections=dict(sorted(totals.rejections.items())),
        could_act=tuple(sorted(totals.could_act)),
        listed=listed,
        ledger=ledger,
    )


def read_entry(place: TaskDataset, header: TaskHeader) -> TaskEntry:
    """The entry of a task dataset whose side files cover its whole ledger. Raises `BadFile`."""
    totals = Totals()
    ledger = Ledger(place.ledger, header, ATTEMPT, totals.add)
    state = LedgerState(ledger.lines, ledger.end, ledger.check)
    return task_entry(header, totals, totals.attempts, state)


def manifest_bytes(entries: Mapping[str, TaskEntry]) -> bytes:
    """The file's content; the same for the same ledgers."""
    by_name = {name: stored(entry) for name, entry in entries.items()}
    return pretty({"dataset_version": DATASET_VERSION, "task_datasets": by_name})


def read_manifest(out: Path) -> Manifest:
    """The manifest of a dataset folder. Raises `BadFile`."""
    return parse_manifest(read_bytes(out), out / MANIFEST)


def entries_there(out: Path) -> Mapping[str, TaskEntry]:
    """Each task dataset that a folder has, if any; the manifest may lack the last few episodes.

    Raises `BadFile`: the manifest is damaged, or of another version.
    """
    if not os.path.exists(out / MANIFEST):  # noqa: PTH110 - that of a path object may raise
        return {}
    return read_manifest(out).task_datasets


def read_bytes(out: Path) -> bytes:
    """What the file holds. Raises `BadFile`: there is none; says where there is one."""
    path = out / MANIFEST
    if not out.is_dir():
        raise BadFile(out, "there is no such folder")
    if not path.is_symlink() and not path.exists():
        above = next((one for one in out.absolute().parents if (one / MANIFEST).is_file()), None)
        begun = any(any(out.glob("*/" * depth + LEDGER)) for depth in range(4))
        again = (
            "resume it; if the manifest was deleted, a repair by `rtphys collect` writes it again"
        )
        cure = f" (a collection has only begun; {again})" if begun else ""
        cure = f" (this is a part of {above})" if begun and above else cure
        raise BadFile(out, f"there is no {MANIFEST} here{cure}")
    return files.read(path)


def parse_manifest(data: bytes, path: Path) -> Manifest:
    """The manifest in the content of a file. Raises `BadFile`: damaged, or of another version."""
    content = parse_mapping(data, path)
    version = content.get("dataset_version")
    if version is None:
        raise BadFile(path, "is no dataset's: it names no dataset_version")
    if version != DATASET_VERSION:
        cure = "collect it again, or read it with the rtphys that wrote it"
        was = f"is of dataset version {shortened(str(version))}"
        raise BadFile(path, f"{was}; this rtphys reads version {DATASET_VERSION}: {cure}")
    return load(Manifest, content, path)


def dataset_digest(manifest: bytes) -> str:
    """One line that identifies a dataset, from the content of its manifest."""
    return f"sha256:{FileFacts.of(manifest).sha256}"
