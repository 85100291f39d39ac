"""One certified list in the making: known rows gain the baselines they lack, new seeds follow."""

from collections.abc import Mapping
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
        self._rows: dict[int, Slot] = {}  # by seed
        self._measured: dict[int, Names] = {}  # likewise
        self._header = {**fingerprint, "first_seed": plan.first_seed}
        self._journal = RowJournal(self.path, self._header)
        self._written = read_instances(self.path) if self.path.exists() else None
        asked = self._read()
        wanted = {*plan.baselines, *asked}.union(*self._measured.values())
        self.baselines = tuple(name for name in BASELINES if name in wanted)
        self._physics = load_protocol(setting.protocol).physics
        self.series = self._series()

    def job(self, seed: int) -> Job:
        return Job(self.setting.at(seed), self._lacking(seed))

    def reason(self, result: Slot) -> str:
        return result.reason

    def commit(self, seed: int, result: Slot) -> str:
        if known := self._rows.get(seed):
            if result.state != known.state:
                now = result.reason or f"state {result.state}"
                return self._halt(
                    seed,
                    f"came out otherwise than in the list: {now}, not state {known.state}; "
                    "a list made on another kind of machine cannot be added to here",
                )
            new = {name: getattr(result, name) for name in self._lacking(seed)}
            result = replace(known, **new)
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
            if self.instances != self._written:
                write_instances(self.path, self.instances)
            self._journal.drop()

    @property
    def whole(self) -> bool:
        """Whether nothing can be added to it."""
        return self.series.enough and not self.series.halted

    @property
    def instances(self) -> InstanceList:
        """What is known so far."""
        of, slots = self.setting, tuple(self._rows.values())
        return InstanceList(of.task, of.protocol, self.fingerprint, slots, self.baselines)

    @property
    def owed(self) -> list[int]:
        """Known feasible seeds that lack a baseline."""
        return [slot.seed for slot in self.instances.feasible if self._lacking(slot.seed)]

    def _lacking(self, seed: int) -> Names:
        """Without physics a twin would be the same world, and is not measured."""
        lacking = {*self.baselines}.difference(self._measured.get(seed, ()))
        return tuple(n for n in self.baselines if n in lacking and (self._physics or n != "twin"))

    def _series(self) -> Series[Job, Slot]:
        plan, owed, known = self.plan, self.owed, self.instances
        name = f"{known.task}, {known.protocol}"
        tally = Tally(name, plan.feasible, len(known.feasible), known.attempts)
        accepted = [True, *(slot.feasible for slot in known.slots)]
        tally.fruitless = min(accepted[::-1].index(True), FRUITLESS)
        new = range(plan.first_seed, plan.first_seed + plan.most_attempts)[known.attempts :]
        return Series(self, tally, [*owed, *new], len(owed))

    def _halt(self, seed: int, text: str) -> str:
        kept = f"{self.path} is not written yet; what is finished is kept beside it"
        return f"seed {seed}: {text}. {kept}"

    def _read(self) -> Names:
        """Takes what is there; returns baselines that were asked for by an earlier version."""
        if known := self._written:
            self._compare(self.path, {**known.fingerprint, "first_seed": known.first_seed})
            for slot in known.slots:
                self._put(slot, _checked(known.baselines, self.path))
        where, stored = self._journal.path, dict(self._journal.stored)
        # Format 1: the first line, and rows of their own, said what the rows behind them hold.
        asked = _checked(stored.pop("baselines", ()), where)
        self._compare(where, stored)
        for entry in self._journal.rows:
            row = dict(entry)
            if "seed" not in row:
                asked += _checked(row["baselines"], where)
            else:
                measured = _checked(row.pop("measured", asked), where)
                self._put(Slot(**row), measured)  # type: ignore[arg-type] - its checksums vouch for `commit`
        return asked

    def _put(self, slot: Slot, measured: Names) -> None:
        """What is neither known nor next stays out: the list it belonged to was deleted, or it
        follows a seed that an earlier version called infeasible because its worker was lost."""
        next_seed = self.plan.first_seed + len(self._rows)
        if slot.reason in LOSSES or not (slot.seed == next_seed or slot.seed in self._rows):
            return
        if {*self._measured.get(slot.seed, ())} <= {*measured}:  # else older than the list
            self._rows[slot.seed], self._measured[slot.seed] = slot, measured

    def _compare(self, path: Path, stored: Mapping[str, JSON]) -> None:
        if clauses := differences(stored, self._header):
            raise CertifiedOtherwise(
                f"{path}: was certified under another fingerprint: {'; '.join(clauses)}. "
                "Delete it to certify anew, or choose another folder"
            )


def _checked(names: object, where: Path) -> Names:
    """Names of baselines, as a file holds them. Raises `UnknownName`."""
    known = tuple(str(name) for name in names) if isinstance(names, list | tuple) else ()
    for name in sorted({*known}.difference(BASELINES)):
        raise UnknownName("baseline", name, BASELINES, where)
    return known
