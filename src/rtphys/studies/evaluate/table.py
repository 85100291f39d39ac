"""One task under one protocol while it is evaluated: what to run, what has come back."""

from dataclasses import dataclass, field

from rtphys.core.errors import BadFile
from rtphys.results import EpisodeRecord
from rtphys.results.instances import InstanceList
from rtphys.results.record_file import RecordFile


@dataclass
class Table:
    """Records are written in the order of the list's seeds, whatever order they come in."""

    task: str
    protocol: str
    instances: InstanceList
    file: RecordFile
    waiting: dict[int, EpisodeRecord] = field(default_factory=dict)  # for an earlier seed's

    def __post_init__(self) -> None:
        self.seeds = [slot.seed for slot in self.instances.feasible]
        known = [record.seed for record in self.file.records]
        # A longer run may stand there: more episodes were asked for once.
        if known[: len(self.seeds)] != self.seeds[: len(known)]:
            raise BadFile(self.file.path, "its seeds are not those of the instance list")
        self.todo = self.seeds[len(known) :]

    @property
    def records(self) -> list[EpisodeRecord]:
        """What is written, of the episodes asked for."""
        return self.file.records[: len(self.seeds)]

    @property
    def successes(self) -> int:
        return sum(record.success for record in self.records)

    def take(self, record: EpisodeRecord) -> None:
        """Files a result, and those that waited for it."""
        self.waiting[record.seed] = record
        while (n := len(self.file.records)) < len(self.seeds) and self.seeds[n] in self.waiting:
            self.file.append(self.waiting.pop(self.seeds[n]))
