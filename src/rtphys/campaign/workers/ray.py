"""A worker pool on the nodes of a Ray cluster.

Each actor keeps one worker process of its own, as on a single machine: a job that crashes, hangs or
leaks ends in the same way in both places, and Ray's threads and signal handlers never share a
process with the simulator. This file handles what is left: actors that vanish, with their node or
alone. Their jobs begin again elsewhere.
"""

# pyright: basic
# Ray tells no types.

import logging
import os
import signal
import time
from collections import deque
from collections.abc import Callable, Hashable
from dataclasses import dataclass
from typing import Generic

import ray
from ray import ObjectRef, exceptions
from ray.actor import ActorHandle

from rtphys.campaign.workers.local import LocalPool
from rtphys.campaign.workers.pool import Done, J, Job, Limits, Lost, R, WorkerFailed, WorkerPool
from rtphys.core.errors import RtphysError

LOSSES = 10  # actors that may vanish over one job; nodes do go, but not that often
IDLE_NOTICE = 30.0  # [s] without a single actor, after which the user is told
SETTINGS = {
    "RAY_gcs_rpc_server_reconnect_timeout_s": "20",  # Ray's own time-out is minutes
    "RAY_USAGE_STATS_ENABLED": "0",  # it would ask, on standard error
    "RAY_ACCEL_ENV_VAR_OVERRIDE_ON_ZERO": "0",  # likewise
}
OBJECT_STORE = 200_000_000  # [bytes] of a private cluster: episodes on their way, 2 MB each


class NoCluster(RtphysError):
    """No Ray cluster at the address that was given."""

    exit_code = 3


def connect(address: str | None = None, workers: int | None = None) -> int:
    """Joins a cluster unless this process is in one; returns the number of workers to use.

    Args:
        address: `host:port`; None: `$RAY_ADDRESS`, else the cluster that this machine belongs to;
            "local": a private one, which ends with this process.
        workers: None: as many as the cluster has CPUs.

    Raises:
        NoCluster: with the cure.
    """
    os.environ.update({**SETTINGS, **os.environ})
    if not ray.is_initialized():
        private = {"num_cpus": workers, "object_store_memory": OBJECT_STORE}
        more = {**private, "include_dashboard": False} if address == "local" else {}
        handler = signal.getsignal(signal.SIGTERM)
        try:
            ray.init(address or "auto", log_to_driver=False, logging_level=logging.ERROR, **more)
        except (ConnectionError, TimeoutError, ValueError, RuntimeError) as error:
            cure = "start one with `ray start --head`, or take address `local`"
            text = f"no Ray cluster at {address or 'hand'}: {_first_line(error)}; {cure}"
            raise NoCluster(text) from error
        finally:
            signal.signal(signal.SIGTERM, handler)  # Ray installs its own
    return workers or max(int(ray.cluster_resources().get("CPU", 1)), 1)


def _first_line(error: Exception) -> str:
    return (str(error).strip() or type(error).__name__).splitlines()[0]


class WorkerActor:
    """A Ray actor that does one job at a time, in a worker process on its node."""

    def __init__(self, setup: Callable[[], Callable], limits: Limits) -> None:
        self._notices: list[str] = []
        self._pool = LocalPool(setup, 1, limits, self._notices.append)

    def ready(self) -> str:
        """Address of the actor's node."""
        return ray.util.get_node_ip_address()

    def do(self, name: Hashable, job: object) -> tuple[Done | Lost | WorkerFailed, list[str]]:
        """What became of a job, and deaths of the worker process on the way."""
        self._notices.clear()
        try:
            self._pool.submit(name, job)
            while not (events := self._pool.wait()):
                pass
            return events[0], self._notices
        except WorkerFailed as failure:
            return failure, self._notices


@dataclass(eq=False)
class _Actor(Generic[J]):
    """An actor as the pool sees it."""

    handle: ActorHandle
    answer: ObjectRef | None  # to `ready`, then to `do`
    node: str = ""  # empty until it is ready
    job: Job[J] | None = None


@dataclass
class RayPool(WorkerPool[J, R]):
    """Workers on the nodes of the cluster that `connect` has joined."""

    def __post_init__(self) -> None:
        self._actors: list[_Actor[J]] = []
        self._queue: deque[Job[J]] = deque()
        self._alone_since = time.monotonic()

    def close(self) -> None:
        for actor in self._actors:
            ray.kill(actor.handle)  # its worker dies with it

    def _begin(self, job: Job[J]) -> None:
        self._queue.append(job)
        self._assign()

    def _assign(self) -> None:
        """Jobs go to actors that are ready: one that waits for a node must hold nothing up."""
        while len(self._actors) < self.busy:
            # Ray must not restart it: it would run a job again without anybody counting.
            kind = ray.remote(num_cpus=1, max_restarts=0, max_task_retries=0)(WorkerActor)
            handle = kind.remote(self.setup, self.limits)
            self._actors.append(_Actor(handle, handle.ready.remote()))  # type: ignore[arg-type] - a proxy is a handle
        for actor in self._actors:
            if self._queue and actor.node and actor.job is None:
                actor.job = self._queue.popleft()
                actor.answer = actor.handle.do.remote(actor.job.name, actor.job.content)

    def _poll(self, timeout: float) -> list[Done[R] | Lost | None]:
        actors = {actor.answer: actor for actor in self._actors if actor.answer is not None}
        answered, _ = ray.wait(list(actors), timeout=timeout)
        events = [self._receive(actors[answer], answer) for answer in answered]
        self._assign()
        if any(actor.node for actor in self._actors):
            self._alone_since = time.monotonic()
        elif time.monotonic() - self._alone_since > IDLE_NOTICE:
            self.notice("the cluster has given no CPU yet; still waiting for one")
            self._alone_since = time.monotonic()
        return events

    def _receive(self, actor: _Actor[J], answer: ObjectRef) -> Done[R] | Lost | None:
        actor.answer = None
        try:
            message = ray.get(answer)
        except exceptions.RayTaskError as error:  # its own code: another rtphys, or a bug
            raise WorkerFailed(f"a Ray worker failed: {error.cause}", 70, str(error)) from error
        except exceptions.RayError as error:  # it died, or its answer was lost with its node
            return self._handle_loss(actor, error)
        if not actor.node:
            actor.node, self.failed_starts = message, 0
            return None
        event, notices = message
        for text in notices:
            self.notice(f"{actor.node}: {text}")
        actor.job = None
        if isinstance(event, WorkerFailed):
            raise event
        return event

    def _handle_loss(self, actor: _Actor[J], error: exceptions.RayError) -> None:
        """Starts the actor's job again elsewhere. A lost node is no verdict on the job."""
        self._actors.remove(actor)
        ray.kill(actor.handle)  # if only its answer was lost
        job = actor.job
        if job is None:
            self.notice(f"lost a worker that was starting: {_first_line(error)}")
            self._count_failed_start(f"Ray workers die while they start: {error}")
            return
        self.notice(f"lost a worker on {actor.node} with {job.name}: {_first_line(error)}")
        job.foreign_deaths += 1
        if job.foreign_deaths > LOSSES:
            count = job.foreign_deaths
            text = f"{job.name}: {count} Ray workers were lost over it; the last: {error}"
            raise WorkerFailed(text) from error
        self._queue.appendleft(job)
