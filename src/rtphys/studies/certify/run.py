"""The supervisor: hands out seeds in order, takes results in any order, survives its workers."""

from collections.abc import Callable, Sequence
from typing import NamedTuple

from rtphys.assets.pack import Pack
from rtphys.campaign.workers.local import Crew
from rtphys.campaign.workers.pool import Lost
from rtphys.data.files import make_folder
from rtphys.data.lock import FolderLock
from rtphys.episode.fingerprint import fingerprint_of
from rtphys.results.instances import Slot
from rtphys.studies.certify.order import Order
from rtphys.studies.certify.plan import CertifyPlan
from rtphys.studies.certify.work import Bench, Job

Told = Callable[[Sequence[Order]], None]


class Name(NamedTuple):
    """An attempt."""

    protocol: str
    task: str
    seed: int

    def __str__(self) -> str:
        return f"{self.task}, {self.protocol}, seed {self.seed}"


def certify(plan: CertifyPlan, pack: Pack, told: Told = lambda _: None) -> list[Order]:
    """Certifies until every list has its feasible seeds, is given up, or meets a lost worker.

    The lists depend on the plan alone, not on the number of workers, nor on how often the run was
    killed and resumed. A seed that takes its workers with it gets no verdict: its list is left as
    it is, `Order.halted` says why, and the same call goes on there.

    Args:
        told: called with all lists whenever one has changed.

    Raises:
        RtphysError: what `CertifyPlan.check` refuses; a list certified on other ground; another
            run at work in the folder; an exception in a worker.
    """
    tasks = plan.check()
    make_folder(plan.out)
    lock = FolderLock(plan.out)
    try:
        orders = {
            (protocol, name): Order(
                plan, name, protocol, fingerprint_of(task, protocol, pack).to_json()
            )
            for protocol in plan.protocols
            for name, task in tasks.items()
        }
        told([*orders.values()])
        with Crew[Job, Slot](Bench(pack), plan.workers, plan.limits) as crew:
            _supervise(orders, crew, told)
    finally:
        lock.release()
    return [*orders.values()]


def _supervise(orders: dict[tuple[str, str], Order], crew: Crew[Job, Slot], told: Told) -> None:
    everyone = [*orders.values()]
    open_ones = list(everyone)
    while True:
        for order in [order for order in open_ones if order.over]:
            order.close()
            open_ones.remove(order)
        while crew.room and (order := next((o for o in open_ones if o.wants), None)):
            job = order.begin()
            crew.submit(Name(order.protocol, order.task, job.recipe.seed), job)
        if not open_ones:
            return
        for event in crew.wait():
            name = event.name
            assert isinstance(name, Name)
            order = orders[name.protocol, name.task]
            if isinstance(event, Lost):
                order.lose(name.seed, event.reason, event.detail)
            else:
                order.take(event.result)
            told(everyone)
