"""A sample of a dataset is simulated again and compared."""

import os
import tempfile
from collections import defaultdict
from collections.abc import Callable, Iterator, Sequence
from contextlib import suppress
from dataclasses import dataclass, field
from itertools import islice
from pathlib import Path

from rtphys.campaign.local import run_here
from rtphys.campaign.pool import LOSSES, WorkerFailure
from rtphys.campaign.series import QUIET, Batch, Listener
from rtphys.core.errors import BadFile, NoRenderer
from rtphys.core.seeds import stream
from rtphys.data.attempts import Accepted, Rejected, read_attempts
from rtphys.data.check_episode import Problem
from rtphys.data.compare import Comparison
from rtphys.data.layout import TaskDataset
from rtphys.data.manifest import Manifest, read_manifest
from rtphys.episode.reproduce import RecordedAttempt, reproduce
from rtphys.sim import renderer
from rtphys.spec.collection import TaskHeader
from rtphys.spec.sweep import paired


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
                    other = "another program drew or encoded it, or it was changed a little"
                    self.notes.append(f"{path}: {text}: {other}")


def reproduced(
    out: Path, count: int, workers: int | None = None, listener: Listener = QUIET
) -> Reproduction:
    """Makes a sample of episodes and of rejected seeds again, all of them if `count` is as large.

    Raises `BadFile`: there is no manifest; `Bug`: an unexpected exception in a worker.
    """
    found = Reproduction()
    known = [*recorded_attempts(out, read_manifest(out), found)]
    # A random sample that nobody could know when the dataset was made.
    rng, attempts = stream(int.from_bytes(os.urandom(7)), "reproduce"), list[RecordedAttempt]()
    for accepted in (True, False):
        having = [attempt for attempt in known if isinstance(attempt.row, Accepted) is accepted]
        picks = rng.choice(len(having), min(count, len(having)), replace=False)
        attempts += [having[index] for index in sorted(picks.tolist())]
    results = dict[int, Comparison]()
    by_shader = defaultdict[str, dict[int, RecordedAttempt]](dict)
    for number, attempt in enumerate(attempts):
        by_shader[attempt.header.spec.recording.shader][number] = attempt
    for shader, jobs in by_shader.items():  # a process draws with one
        batch = Batch("reproduce", jobs, lost)
        run_here([batch], ReproduceWorker(shader), workers, listener)
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
        try:
            for row in islice(read_attempts(entry.below(out).ledger), entry.attempts):
                yield RecordedAttempt(out, entry.header, row, tuple(others.get(name, ())))
        except BadFile as error:
            text = f"{name} cannot be made again: {error.problem}"
            found.problems.append(Problem(error.path, text))


def lost(attempt: RecordedAttempt, loss: WorkerFailure) -> Comparison:
    """What comes of an attempt that took its workers with it."""
    if isinstance(attempt.row, Rejected) and attempt.row.reason in LOSSES:  # as when collected
        return Comparison(made=False)
    return Comparison([(attempt.place.ledger, f"{attempt.name}: {loss}")], made=False)


@dataclass(frozen=True)
class ReproduceWorker:
    """Makes attempts again; draws them where this machine can."""

    shader: str

    def __call__(self) -> Callable[[RecordedAttempt], Comparison]:
        with suppress(NoRenderer):
            renderer.ready(self.shader)
        return self.do

    def do(self, job: RecordedAttempt) -> Comparison:
        """One attempt, in a folder of its own."""
        with tempfile.TemporaryDirectory(prefix="rtphys-reproduce-") as folder:
            return reproduce(job, Path(folder) / "episode")
