"""The supervisor: hands out seeds in order, takes results in any order, survives its workers."""

import time
from collections.abc import Callable, Sequence
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path

from rtphys.assets.pack import Pack, chosen_pack
from rtphys.campaign.workers.pool import Done, WorkerFailed, Workers
from rtphys.core.errors import RtphysError
from rtphys.data.writer import DatasetWriter
from rtphys.studies.collect.crew import crew_of, size_of
from rtphys.studies.collect.order import Name, Order
from rtphys.studies.collect.plan import CollectPlan
from rtphys.studies.collect.remote import Sent
from rtphys.studies.collect.shard import claim
from rtphys.studies.collect.tally import Tally
from rtphys.studies.collect.work import Desk, Job, Results
from rtphys.task.spec import Task

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


Known = Callable[[str, int, Sequence[Path]], Results | None]
"""(task, seed, folders for the files) -> what came of that attempt elsewhere; None: not known."""


def collect(
    plan: CollectPlan, listener: Listener | None = None, known: Known | None = None
) -> Summary:
    """Collects until every task has its episodes, or is given up.

    The dataset depends on the plan alone, not on the number of workers, nor on how often the run
    was killed and resumed. Interrupted by an exception, it leaves a valid prefix.

    Args:
        known: spares attempts that were made elsewhere under the same conditions.

    Raises:
        RtphysError: what `CollectPlan.check` and `DatasetWriter` refuse; a full disk.
        Bug: an unexpected exception in a worker.
    """
    told = listener or Listener()
    tasks = plan.check()
    size_of(plan)  # is there a cluster at all?
    pack = chosen_pack(plan.assets, plan.fallback, told.building)
    plan.check_assets(tasks, pack)
    began = time.monotonic()
    desk = Desk(pack, plan.cameras, plan.layout, plan.shader)
    with DatasetWriter(plan.out, resume=plan.resume) as dataset:
        claim(plan.out, plan.shard)
        orders = _open(plan, tasks, pack, dataset)
        told.started([order.tally for order in orders.values()])
        with crew_of(plan, desk, told.noticed) as crew:
            try:
                _supervise(orders, crew, dataset, told, known)
            except WorkerFailed as failure:
                raise _explained(failure, plan.out) from failure
    return Summary(plan.out, [o.tally for o in orders.values()], time.monotonic() - began)


def _open(
    plan: CollectPlan, tasks: dict[str, Task], pack: Pack, dataset: DatasetWriter
) -> dict[str, Order]:
    sides = [plan] if plan.twin_plan is None else [plan, plan.twin_plan]
    return {
        name: Order.open(
            plan,
            task,
            tuple(dataset.task(side.conditions(task, pack), plan.share) for side in sides),
        )
        for name, task in tasks.items()
    }


def _supervise(
    orders: dict[str, Order],
    crew: Workers[Job, Sent],
    dataset: DatasetWriter,
    told: Listener,
    known: Known | None,
) -> None:
    while True:
        while crew.room and (
            order := next((o for o in orders.values() if o.wants(crew.size)), None)
        ):
            name, job = order.begin()
            found = known(*name, job.folders) if known else None
            if found is None:
                crew.submit(name, job)
            else:
                order.take(name.seed, Done(name, found))
        if not any(order.under_way and not order.over for order in orders.values()):
            return
        for event in crew.wait():
            assert isinstance(event.name, Name)
            orders[event.name.task].take(event.name.seed, event)
            dataset.checkpoint_if_due()
            told.ticked()
        told.ticked()


def _explained(failure: WorkerFailed, out: Path) -> RtphysError:
    """A bug's traceback goes to a file; what a user can cause is passed on as it is."""
    if not failure.trace:
        return failure
    log, place = out / ERROR_LOG, ""
    with suppress(OSError):
        log.write_text(failure.trace + "\n")
        place = f"; the traceback is in {log}"
    return Bug(f"{failure}. This is a bug in rtphys or in the task{place}")
