"""Where the work of a collection is done: on this machine, or on a cluster."""

from collections.abc import Callable

from rtphys.campaign.workers.local import Crew, cores
from rtphys.campaign.workers.pool import Workers
from rtphys.studies.collect.plan import CollectPlan
from rtphys.studies.collect.remote import RemoteDesk, Sent
from rtphys.studies.collect.work import Desk, Job


def crew_of(plan: CollectPlan, desk: Desk, notice: Callable[[str], None]) -> Workers[Job, Sent]:
    """The crew that `plan.runner` names.

    Raises:
        NoCluster: there is none to join.
    """
    size = size_of(plan)
    if plan.runner == "local":
        return Crew[Job, Sent](desk, size, plan.limits, notice)
    # Imported here: Ray is optional.
    from rtphys.campaign.workers.ray import RayCrew

    setup = RemoteDesk.of(plan, desk)
    return RayCrew[Job, Sent](setup, size, plan.limits, notice)


def size_of(plan: CollectPlan) -> int:
    """Workers: as many as were asked for, else one for each CPU.

    Raises:
        NoCluster: there is none to join.
    """
    if plan.runner == "local":
        return cores() if plan.workers is None else plan.workers
    from rtphys.campaign.workers.ray_cluster import connect

    return connect(plan.address, plan.workers)
