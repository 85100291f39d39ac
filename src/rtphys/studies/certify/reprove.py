"""Proving lists again: their first instances are solved, and stale headers that hold renewed."""

from dataclasses import dataclass, field, replace
from pathlib import Path

from rtphys.assets.pack import Pack
from rtphys.campaign.engine import Listener, run_all
from rtphys.campaign.series import Series, Study, Tally
from rtphys.campaign.workers.local import LocalPool, cores
from rtphys.campaign.workers.pool import Limits, Lost
from rtphys.core.errors import BadValue
from rtphys.data.conditions import differences
from rtphys.data.episode import JSON
from rtphys.data.lock import FolderLock
from rtphys.results.instance_file import instance_file, read_instances, write_instances
from rtphys.results.instances import InstanceList, Slot
from rtphys.setting.setting import Setting
from rtphys.studies.certify.certified_list import Job
from rtphys.studies.certify.plan import CertifyPlan
from rtphys.studies.certify.run import CertifyWorker, fingerprint


@dataclass
class Reproof(Study[Job, Slot]):
    """The first instances of one list, solved again."""

    path: Path
    setting: Setting
    listed: InstanceList
    fingerprint: dict[str, JSON]  # as it is now
    solved: int = 0
    differences: list[str] = field(default_factory=list[str])  # one sentence for each seed
    renewed: bool = False

    @property
    def stale(self) -> list[str]:
        """One clause for each part of the fingerprint that is not the list's."""
        return differences(self.listed.fingerprint, self.fingerprint)

    def job(self, seed: int) -> Job:
        return Job(self.setting.at(seed), ())

    def reason(self, result: Slot) -> str:
        return ""

    def commit(self, seed: int, result: Slot) -> str:
        (state,) = (slot.state for slot in self.listed.slots if slot.seed == seed)
        self.solved += 1
        if result.state != state:
            now = result.reason or f"state {result.state}"
            self.differences.append(f"{self.path}: seed {seed}: now {now}, not state {state}")
        return ""

    def lost(self, seed: int, loss: Lost) -> Slot:
        return Slot(seed, loss.reason)

    def series(self, instances: int) -> Series[Job, Slot]:
        """The seeds to solve."""
        seeds = [slot.seed for slot in self.listed.feasible[:instances]]
        return Series(self, Tally(f"{self.listed.task}, {self.listed.protocol}", len(seeds)), seeds)

    def renew(self) -> None:
        """Gives a list that holds the present fingerprint; the rest stays. Raises `CannotWrite`."""
        if self.solved and self.stale and not self.differences:
            write_instances(self.path, replace(self.listed, fingerprint=self.fingerprint))
            self.renewed = True


def reprove(plan: CertifyPlan, pack: Pack, listener: Listener | None = None) -> list[Reproof]:
    """Solves the first `plan.reprove` instances of every list of the plan that is there.

    A list all of whose states agree to the last bit carries the present fingerprint afterwards.
    One that differs stays as it is, and stale.

    Raises:
        BadValue: the folder holds none of the lists.
        BadFile, SchemaError: a list is damaged.
    """
    listener = listener or Listener()
    studies = [
        Reproof(path, setting, read_instances(path), dict(fingerprint(setting, pack)))
        for setting in plan.settings()
        if (path := instance_file(plan.out, setting.protocol, setting.task)).is_file()
    ]
    if not studies:
        raise BadValue("out", str(plan.out), "a folder with lists of these tasks and protocols")
    series = [study.series(plan.reprove) for study in studies]
    worker, size = CertifyWorker(pack), plan.workers or cores()
    with FolderLock(plan.out):
        with LocalPool[Job, Slot](worker, size, Limits(), listener.noticed) as pool:
            run_all(series, pool, listener)
        for study in studies:
            study.renew()
    return studies
