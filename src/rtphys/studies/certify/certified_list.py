"""One certified list in the making: known rows gain the baselines they lack, new seeds follow."""

from collections.abc import Iterable, Mapping
from dataclasses import asdict, dataclass, replace
from pathlib import Path

from rtphys.campaign.row_journal import RowJournal
from rtphys.campaign.series import FRUITLESS, Series, Study, Tally
from rtphys.campaign.workers.pool import LOSSES, Lost
from rtphys.core.errors import RtphysError, UnknownName
from rtphys.data.conditions import differences
from rtphys.data.episode import JSON
from rtphys.results.instance_file import instance_file, read_instances, write_instances
from rtphys.results.instances import InstanceList, Slot
from rtphys.setting.protocol import load_protocol
from rtphys.setting.setting import Recipe, Setting
from rtphys.studies.certify.plan import BASELINES, CertifyPlan

Names = tuple[str, ...]


class CertifiedOtherwise(RtphysError):
    """A list, or a part of one, has another certification fingerprint and cannot be continued."""

    def __init__(self, path: Path, clauses: list[str]) -> None:
        super().__init__(
            f"{path}: was certified under another fingerprint: {'; '.join(clauses)}. "
            "Delete it to certify anew, or choose another folder"
        )


@dataclass(frozen=True)
class Job:
    """One seed, and what to measure on it if it is feasible."""

    recipe: Recipe
    baselines: Names


class CertifiedList(Study[Job, Slot]):
    """Slots of consecutive seeds from the first one, each with the baselines measured on it.

    A list's baselines only grow: every row is owed all that were ever measured or asked for, or
    else a list would depend on the order of the questions. The file is written when it is whole;
    until then a journal beside it holds what is new, the newest line of a seed being in force.

    Raises:
        CertifiedOtherwise: what is there has another fingerprint or first seed.
        BadFile, UnknownName: it is damaged; it names a baseline that does not exist.
    """

    def __init__(
        self, plan: CertifyPlan, setting: Setting, fingerprint: Mapping[str, JSON]
    ) -> None:
        self.setting, self.fingerprint, self.plan = setting, fingerprint, plan
        self.path = instance_file(plan.out, setting.protocol, setting.task)
        self.slots: list[Slot] = []
        self._measured: list[Names] = []  # of each slot
        self._written: InstanceList | None = None
        header = {**fingerprint, "first_seed": self.plan.first_seed}
        self._journal = RowJournal(self.path, header)
        asked = self._read(header)
        self.baselines = _union(plan.wanted_baselines, asked, *self._measured, where=self.path)
        self._measurable = measurable(self.baselines, setting.protocol)
        self.series = self._series()

    # ---- what the engine asks --------------------------------------------------------------------

    def job(self, seed: int) -> Job:
        return Job(self.setting.at(seed), self._lacking(seed - self.plan.first_seed))

    def reason(self, result: Slot) -> str:
        return result.reason

    def commit(self, seed: int, result: Slot) -> str:
        index = seed - self.plan.first_seed
        if index < len(self.slots):
            known = self.slots[index]
            if result.state != known.state:
                now = result.reason or f"state {result.state}"
                return self._halt(
                    seed,
                    f"came out otherwise than in the list: {now}, not state {known.state}; "
                    "a list made on another kind of machine cannot be added to here",
                )
            result = _joined(known, result)
        self._put(result, self.baselines)
        self._journal.append({**asdict(result), "measured": list(self.baselines)})
        return ""

    def lost(self, seed: int, loss: Lost) -> str:
        return self._halt(
            seed,
            f"{loss.reason}: the last worker that tried it {loss.detail}, which "
            "is no verdict on the seed; the same command tries it again",
        )

    def close(self) -> None:
        """Writes the list if it is whole. Raises `CannotWrite`."""
        if self.whole:
            made = InstanceList(
                self.setting.task,
                self.setting.protocol,
                self.fingerprint,
                tuple(self.slots),
                self.baselines,
            )
            if made != self._written:
                write_instances(self.path, made)
                self._written = made
            self._journal.drop()

    @property
    def whole(self) -> bool:
        """Whether nothing can be added to it."""
        return self.series.enough and not self.series.halted

    @property
    def feasible(self) -> list[Slot]:
        return [slot for slot in self.slots if slot.feasible]

    @property
    def owed(self) -> list[int]:
        """Known feasible seeds that lack a baseline."""
        first = self.plan.first_seed
        return [
            first + i for i, slot in enumerate(self.slots) if slot.feasible and self._lacking(i)
        ]

    # ----------------------------------------------------------------------------------------------

    def _lacking(self, index: int) -> Names:
        known = self._measured[index] if index < len(self.slots) else ()
        return tuple(name for name in self._measurable if name not in known)

    def _series(self) -> Series[Job, Slot]:
        plan, owed = self.plan, self.owed
        name = f"{self.setting.task}, {self.setting.protocol}"
        tally = Tally(name, plan.feasible, len(self.feasible), len(self.slots))
        accepted = [True, *(slot.feasible for slot in self.slots)]
        tally.fruitless = min(accepted[::-1].index(True), FRUITLESS)
        end = self.plan.first_seed + plan.most_attempts
        new = range(self.plan.first_seed + len(self.slots), end)
        return Series(self, tally, [*owed, *new], len(owed))

    def _halt(self, seed: int, text: str) -> str:
        kept = f"{self.path} is not written yet; what is finished is kept beside it"
        return f"seed {seed}: {text}. {kept}"

    def _read(self, header: Mapping[str, JSON]) -> Names:
        """Takes what is there; returns baselines that were asked for by an earlier version."""
        if self.path.exists():
            self._written = known = read_instances(self.path)
            _compare(self.path, {**known.fingerprint, "first_seed": known.first_seed}, header)
            for slot in known.slots:
                self._put(slot, _union(known.baselines, where=self.path))
        where, stored = self._journal.path, dict(self._journal.stored)
        # Format 1: the first line, and rows of their own, said what the rows behind them hold.
        asked = _union(_names(stored.pop("baselines", [])), where=where)
        _compare(where, stored, header)
        for entry in self._journal.rows:
            if "seed" not in entry:
                asked = _union(asked, _names(entry["baselines"]), where=where)
                continue
            row = dict(entry)
            measured = _names(row.pop("measured", list(asked)))
            self._put(Slot(**row), _union(measured, where=where))  # type: ignore[arg-type] - its checksums vouch for `commit`
        return asked

    def _put(self, slot: Slot, measured: Names) -> None:
        """What is neither known nor next stays out: the list it belonged to was deleted, or it
        follows a seed that an earlier version called infeasible because its worker was lost."""
        index = slot.seed - self.plan.first_seed
        if not 0 <= index <= len(self.slots) or slot.reason in LOSSES:
            return
        if index < len(self.slots) and not {*self._measured[index]} <= {*measured}:
            return  # older than the list
        self.slots[index : index + 1] = [slot]
        self._measured[index : index + 1] = [measured]


def measurable(baselines: Names, protocol: str) -> Names:
    """Those that make sense under a protocol: without physics a twin would be the same world.

    Raises:
        UnknownName: no such protocol.
    """
    physics = load_protocol(protocol).physics
    return tuple(name for name in baselines if physics or name != "twin")


def _union(*names: Iterable[str], where: Path | str) -> Names:
    """In the order of `BASELINES`. Raises `UnknownName`."""
    wanted = {name for group in names for name in group}
    for name in sorted(wanted.difference(BASELINES)):
        raise UnknownName("baseline", name, BASELINES, where)
    return tuple(name for name in BASELINES if name in wanted)


def _joined(known: Slot, new: Slot) -> Slot:
    replay = known.replay if new.replay is None else new.replay
    return replace(known, replay=replay, twin=known.twin if new.twin is None else new.twin)


def _names(value: JSON) -> Names:
    return tuple(str(name) for name in value) if isinstance(value, list) else ()


def _compare(path: Path, stored: Mapping[str, JSON], wanted: Mapping[str, JSON]) -> None:
    if clauses := differences(stored, wanted):
        raise CertifiedOtherwise(path, clauses)
