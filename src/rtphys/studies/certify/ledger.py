"""The rows of one list on the disk: the list itself, and a journal of what is not in it yet."""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path

from rtphys.campaign.workers.pool import LOSSES
from rtphys.core.errors import RtphysError, UnknownName
from rtphys.data.conditions import differences
from rtphys.data.episode import JSON
from rtphys.data.files import make_folder
from rtphys.data.journal import Journal
from rtphys.results.instance_file import instance_file, read_instances, write_instances
from rtphys.results.instances import InstanceList, Slot
from rtphys.studies.certify.plan import BASELINES


class CertifiedOtherwise(RtphysError):
    """A list, or a part of one, was certified on other ground and cannot be continued."""

    def __init__(self, path: Path, found: list[str]) -> None:
        super().__init__(
            f"{path}: was certified on other ground: {'; '.join(found)}. "
            "Delete it to certify anew, or choose another --out"
        )


@dataclass
class Ledger:
    """Slots of consecutive seeds from the first one, each with the baselines it is measured by.

    A list's baselines only grow: every row is owed all that were ever asked for, whoever asked,
    or else a list would depend on the order of the questions.

    The journal's first line is the ground with the baselines owed by then; then come slots, each
    the newest word on its seed, and between them `{"baselines": ...}` wherever more was asked for.

    Raises:
        CertifiedOtherwise: what is there has another ground or first seed.
        BadFile, UnknownName: it is damaged; it names a baseline that does not exist.
    """

    out: Path
    task: str
    protocol: str
    ground: Mapping[str, JSON]
    first_seed: int
    baselines: tuple[str, ...]  # as asked for; then all that are owed
    slots: list[Slot] = field(default_factory=list)

    def __post_init__(self) -> None:
        self.path = instance_file(self.out, self.protocol, self.task)
        make_folder(self.path.parent)
        self._measured: list[tuple[str, ...]] = []  # of each slot
        self._known: InstanceList | None = None
        self._promised: tuple[str, ...] | None = None  # by the journal
        asked, self.baselines = self.baselines, ()
        if self.path.exists():
            self._read_list()
        self._journal = Journal(self.path.parent / f".{self.task}.journal")
        self._read_journal()
        self.baselines = _union(asked, self.baselines, "--baselines")

    @property
    def expected(self) -> int:
        """The seed of the next new slot."""
        return self.first_seed + len(self.slots)

    def slot(self, seed: int) -> Slot:
        return self.slots[seed - self.first_seed]

    def lacking(self) -> dict[int, tuple[str, ...]]:
        """Feasible seeds that are owed baselines, with these; in the order of seeds."""
        rows = zip(self.slots, self._measured, strict=True)
        owed = {
            slot.seed: tuple(name for name in self.baselines if name not in measured)
            for slot, measured in rows
            if slot.feasible
        }
        return {seed: names for seed, names in owed.items() if names}

    def promise(self) -> None:
        """Writes down what is owed, so that a run that is killed still owes it."""
        if self._promised == self.baselines:
            return
        owed: dict[str, JSON] = {"baselines": list(self.baselines)}
        self._journal.append(owed if self._journal.count else {**self._head, **owed}, durable=True)
        self._promised = self.baselines

    def commit(self, slot: Slot) -> None:
        """Keeps a new slot, or the baselines that a known one was owed. Raises `CannotWrite`."""
        self.promise()
        if slot.seed < self.expected:
            slot = _joined(self.slot(slot.seed), slot)
        self._journal.append(_entry(slot), durable=True)
        self._put(slot, self.baselines)

    def write(self) -> None:
        """Writes the list, then drops the journal. Raises `CannotWrite`."""
        slots = tuple(self.slots)
        made = InstanceList(self.task, self.protocol, self.ground, slots, self.baselines)
        if made != self._known:
            write_instances(self.path, made)
            self._known = made
        self._journal.path.unlink(missing_ok=True)

    # ---- what is on the disk ---------------------------------------------------------------------

    @property
    def _head(self) -> dict[str, JSON]:
        return {**self.ground, "first_seed": self.first_seed}

    def _read_list(self) -> None:
        self._known = known = read_instances(self.path)
        _compare(self.path, {**known.fingerprint, "first_seed": known.first_seed}, self._head)
        self.baselines = _union(known.baselines, (), self.path)
        for slot in known.slots:
            self._put(slot, self.baselines)

    def _read_journal(self) -> None:
        entries = self._journal.entries()
        if not entries:
            return
        path, head = self._journal.path, dict(entries[0])
        owed = _union(_names(head.pop("baselines", [])), (), path)
        _compare(path, head, self._head)
        for entry in entries[1:]:
            if "seed" in entry:
                self._put(_slot(entry), owed)
            else:
                owed = _union(_names(entry["baselines"]), owed, path)
        self._promised = owed
        self.baselines = _union(owed, self.baselines, path)

    def _put(self, slot: Slot, measured: tuple[str, ...]) -> None:
        """What is neither known nor next stays out: the list it belonged to was deleted, or it
        follows a seed that an earlier version called infeasible because its worker was lost."""
        index = slot.seed - self.first_seed
        if not 0 <= index <= len(self.slots) or slot.reason in LOSSES:
            return
        if index < len(self.slots) and not {*self._measured[index]} <= {*measured}:
            return  # older than the list
        self.slots[index : index + 1] = [slot]
        self._measured[index : index + 1] = [measured]


def _union(names: Iterable[str], more: Iterable[str], where: Path | str) -> tuple[str, ...]:
    """In the order of `BASELINES`. Raises `UnknownName`."""
    wanted = {*names, *more}
    for name in sorted(wanted.difference(BASELINES)):
        raise UnknownName("baseline", name, BASELINES, where)
    return tuple(name for name in BASELINES if name in wanted)


def _joined(known: Slot, new: Slot) -> Slot:
    replay = known.replay if new.replay is None else new.replay
    return replace(known, replay=replay, twin=known.twin if new.twin is None else new.twin)


def _entry(slot: Slot) -> dict[str, JSON]:
    return {
        "seed": slot.seed,
        "reason": slot.reason,
        "state": slot.state,
        "replay": slot.replay,
        "twin": slot.twin,
    }


def _slot(entry: Mapping[str, JSON]) -> Slot:
    return Slot(**entry)  # type: ignore[arg-type] - the journal's checksums vouch for `_entry`


def _names(value: JSON) -> list[str]:
    return [str(name) for name in value] if isinstance(value, list) else []


def _compare(path: Path, stored: Mapping[str, JSON], wanted: Mapping[str, JSON]) -> None:
    if found := differences(stored, wanted):
        raise CertifiedOtherwise(path, found)
