"""Workers of `certify` that need no simulator, and may be told to die on one seed."""

from collections.abc import Callable, Hashable
from dataclasses import dataclass, field

from pool_jobs import Trouble, do
from rtphys.studies.certify.work import Job

from rtphys.assets.pack import Pack
from rtphys.campaign.workers.pool import Done, Limits, Lost, Workers
from rtphys.results.instances import FIRST_SEED, Slot

LOST = FIRST_SEED + 4  # the seed whose worker gets into trouble, when clean


def verdict(seed: int, baselines: tuple[str, ...]) -> Slot:
    """Every third seed is infeasible; the others' columns differ from each other."""
    if seed % 3 == 0:
        return Slot(seed, "slipped")
    replay = seed % 2 == 0 if "replay" in baselines else None
    twin = seed % 5 == 0 if "twin" in baselines else None
    return Slot(seed, "", f"{seed:016x}", replay, twin)


@dataclass(frozen=True)
class QuickBench:
    """In the place of `rtphys.studies.certify.work.Bench`, in processes."""

    pack: Pack
    trouble: Trouble = field(default_factory=Trouble)

    def __call__(self) -> Callable[[Job], Slot]:
        return self.do

    def do(self, job: Job) -> Slot:
        if (job.recipe.seed, job.recipe.protocol) == (LOST, "clean"):
            do(self.trouble)
        return verdict(job.recipe.seed, job.baselines)


class QuickCrew(Workers[Job, Slot]):
    """Runs jobs in this process; what began last ends first."""

    reason = ""  # of a loss over `LOST`

    def __class_getitem__(cls, _: object) -> "type[QuickCrew]":
        return cls  # as if it were generic, as the other is

    def __init__(self, setup: Callable[[], Callable[[Job], Slot]], size: int, _: Limits) -> None:
        super().__init__(setup, size)
        self._jobs: list[tuple[Hashable, Job]] = []

    @property
    def busy(self) -> int:
        return len(self._jobs)

    def submit(self, name: Hashable, job: Job) -> None:
        self._jobs.append((name, job))

    def wait(self, timeout: float = 1.0) -> list[Done[Slot] | Lost]:
        name, job = self._jobs.pop()
        if self.reason and (job.recipe.seed, job.recipe.protocol) == (LOST, "clean"):
            return [Lost(name, self.reason, "was killed by SIGKILL")]
        return [Done(name, verdict(job.recipe.seed, job.baselines))]

    def close(self) -> None:
        self._jobs.clear()


class CrashingCrew(QuickCrew):
    reason = "worker_crash"


class HangingCrew(QuickCrew):
    reason = "worker_hang"
