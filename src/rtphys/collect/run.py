"""The supervisor: hands out seeds in order, takes results in any order, survives its workers."""

import math
import time
from contextlib import suppress
from dataclasses import dataclass, field
from pathlib import Path
from typing import NamedTuple

from rtphys.assets.pack import Pack, default_pack
from rtphys.collect.plan import BARREN, CollectPlan
from rtphys.collect.tally import Tally
from rtphys.collect.work import Desk, Job, Result, rejection
from rtphys.data.leaf_writer import TaskWriter
from rtphys.data.staging import StagedEpisode
from rtphys.data.writer import DatasetWriter
from rtphys.errors import RtphysError
from rtphys.runners.local import Crew, Done, Lost, WorkerFailed
from rtphys.task.spec import Task

LOOKAHEAD = 4  # results a worker may be ahead of the slowest: bounds what waits on the disk
ERROR_LOG = "error.log"


class Bug(RtphysError):
    """An exception that no one expected; the traceback lies in a file."""

    exit_code = 70  # EX_SOFTWARE


class Listener:
    """Is told what happens. Every method may be overridden; none may take long."""

    def building(self, done: int, total: int, name: str) -> None:
        """The asset pack is being built."""

    def started(self, tallies: list[Tally]) -> None:
        """Everything is checked; the tallies will change in place."""

    def ticked(self) -> None:
        """Called at least once a second, and after every attempt."""

    def noticed(self, text: str) -> None:
        """A worker died or was replaced."""


@dataclass(frozen=True)
class Summary:
    """What came of a run."""

    out: Path
    tallies: list[Tally]
    seconds: float

    @property
    def complete(self) -> bool:
        return all(tally.done for tally in self.tallies)


class Name(NamedTuple):
    """An attempt."""

    task: str
    seed: int

    def __str__(self) -> str:
        return f"{self.task}, seed {self.seed}"


@dataclass
class _Order:
    """One task's attempts: which seeds to hand out, which results to wait for."""

    plan: CollectPlan
    task: Task
    writer: TaskWriter
    tally: Tally
    next_seed: int
    under_way: set[int] = field(default_factory=set)
    waiting: dict[int, Result] = field(default_factory=dict)  # for an earlier seed's result

    @staticmethod
    def open(plan: CollectPlan, task: Task, writer: TaskWriter) -> "_Order":
        tried = writer.next_seed - plan.first_seed
        tally = Tally(task.name, plan.episodes, writer.episodes, tried, writer.episodes, tried)
        order = _Order(plan, task, writer, tally, writer.next_seed)
        order._give_up_if_hopeless()
        return order

    @property
    def wants(self) -> bool:
        """Whether one more attempt should begin: as many as the missing episodes are worth."""
        tally = self.tally
        if tally.done or tally.stopped:
            return False
        most = self.plan.most_attempts
        if most is not None and self.next_seed >= self.plan.first_seed + most:
            return False
        if self.next_seed - self.writer.next_seed >= LOOKAHEAD * self.plan.workers:
            return False
        ready = sum(isinstance(result, StagedEpisode) for result in self.waiting.values())
        missing = tally.wanted - tally.episodes - ready
        return len(self.under_way) < math.ceil(missing / tally.rate)

    def begin(self) -> tuple[Name, Job]:
        seed = self.next_seed
        self.next_seed += 1
        self.under_way.add(seed)
        recipe = self.plan.recipe(self.task.name, seed)
        return Name(self.task.name, seed), Job(recipe, self.writer.staging(seed))

    def take(self, seed: int, event: Done[Result] | Lost) -> None:
        """Files a result; counts all that are committed with it."""
        self.under_way.discard(seed)
        if self.tally.done or self.tally.stopped:  # it was begun to be on the safe side
            return
        if isinstance(event, Done):
            result = event.result
        else:
            recipe = self.plan.recipe(self.task.name, seed)
            result = rejection(recipe, event.reason, event.detail)
        self.waiting[seed] = result
        for committed in self.writer.record(result):
            known = self.waiting.pop(committed)
            if isinstance(known, StagedEpisode):
                self.tally.accepted(known.frames)
            else:
                self.tally.rejected(known.reason)
        self._give_up_if_hopeless()

    def _give_up_if_hopeless(self) -> None:
        tally, most = self.tally, self.plan.most_attempts
        if tally.done:
            return
        if tally.barren >= BARREN:
            tally.stopped = f"none of the last {tally.barren} attempts was accepted"
        elif most is not None and tally.attempts >= most:
            tally.stopped = f"{tally.attempts} attempts were made, the most that were allowed"


def collect(plan: CollectPlan, listener: Listener | None = None) -> Summary:
    """Collects until every task has its episodes, or is given up.

    The dataset depends on the plan alone, not on the number of workers, nor on how often the run
    was killed and resumed. Interrupted by an exception, it leaves a valid prefix.

    Raises:
        RtphysError: what `CollectPlan.check` and `DatasetWriter` refuse; a full disk.
        Bug: an unexpected exception in a worker.
    """
    told = listener or Listener()
    tasks = plan.check()
    pack = default_pack(told.building)
    plan.check_assets(tasks, pack)
    began = time.monotonic()
    desk = Desk(pack, plan.cameras, plan.layout, plan.shader)
    with DatasetWriter(plan.out, resume=plan.resume) as dataset:
        orders = _open(plan, tasks, pack, dataset)
        told.started([order.tally for order in orders.values()])
        with Crew[Job, Result](desk, plan.workers, plan.limits, told.noticed) as crew:
            try:
                _supervise(orders, crew, dataset, told)
            except WorkerFailed as failure:
                raise _explained(failure, plan.out) from failure
    return Summary(plan.out, [o.tally for o in orders.values()], time.monotonic() - began)


def _open(
    plan: CollectPlan, tasks: dict[str, Task], pack: Pack, dataset: DatasetWriter
) -> dict[str, _Order]:
    return {
        name: _Order.open(plan, task, dataset.task(plan.conditions(task, pack), plan.episodes))
        for name, task in tasks.items()
    }


def _supervise(
    orders: dict[str, _Order], crew: Crew[Job, Result], dataset: DatasetWriter, told: Listener
) -> None:
    while True:
        while crew.room and (order := next((o for o in orders.values() if o.wants), None)):
            crew.submit(*order.begin())
        if not any(order.under_way and not _over(order) for order in orders.values()):
            return
        for event in crew.wait():
            assert isinstance(event.name, Name)
            orders[event.name.task].take(event.name.seed, event)
            dataset.checkpoint_if_due()
            told.ticked()
        told.ticked()


def _over(order: _Order) -> bool:
    return order.tally.done or bool(order.tally.stopped)


def _explained(failure: WorkerFailed, out: Path) -> RtphysError:
    """A bug's traceback goes to a file; what a user can cause is passed on as it is."""
    if not failure.trace:
        return failure
    log, place = out / ERROR_LOG, ""
    with suppress(OSError):
        log.write_text(failure.trace + "\n")
        place = f"; the traceback is in {log}"
    return Bug(f"{failure}. This is a bug in rtphys or in the task{place}")
