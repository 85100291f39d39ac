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
from typing import Generic, TypeVar

import ray
from ray import ObjectRef, exceptions
from ray.actor import ActorHandle

from rtphys.campaign.workers.local import START_TRIES, LocalPool
from rtphys.campaign.workers.pool import Done, Limits, Lost, WorkerFailed, WorkerPool
from rtphys.core.errors import RtphysError

J = TypeVar("J")
R = TypeVar("R")

LOSSES = 10  # actors that may vanish over one job; nodes do go, but not that often
IDLE_NOTICE = 30.0  # [s] without a single actor, after which the user is told
CLOSE_SECONDS = 5.0  # [s] in which actors may end their workers
OBJECT_STORE = 200_000_000  # [bytes] of a private cluster: episodes on their way, 2 MB each
CONNECT_SECONDS = 20  # Ray's own time-out is minutes


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
    os.environ.setdefault("RAY_gcs_rpc_server_reconnect_timeout_s", str(CONNECT_SECONDS))
    os.environ.setdefault("RAY_USAGE_STATS_ENABLED", "0")  # it would ask, on standard error
    os.environ.setdefault("RAY_ACCEL_ENV_VAR_OVERRIDE_ON_ZERO", "0")  # likewise
    if not ray.is_initialized():
        handler = signal.getsignal(signal.SIGTERM)
        try:
            _init(address, workers)
        except (ConnectionError, TimeoutError, ValueError, RuntimeError) as error:
            cure = "start one with `ray start --head`, or take address `local`"
            first = (str(error).strip().splitlines() or [type(error).__name__])[0]
            raise NoCluster(f"no Ray cluster at {address or 'hand'}: {first}; {cure}") from error
        finally:
            signal.signal(signal.SIGTERM, handler)  # Ray installs its own
    return workers or max(int(ray.cluster_resources().get("CPU", 1)), 1)


def _init(address: str | None, workers: int | None) -> None:
    if address == "local":
        ray.init(
            address="local",
            num_cpus=workers,
            object_store_memory=OBJECT_STORE,
            include_dashboard=False,
            log_to_driver=False,
            logging_level=logging.ERROR,
        )
    else:
        ray.init(address=address or "auto", log_to_driver=False, logging_level=logging.ERROR)


@dataclass(frozen=True)
class Report:
    """What an actor sends back after a job."""

    event: Done | Lost | WorkerFailed
    notices: tuple[str, ...]  # deaths of its workers


class WorkerActor:
    """A Ray actor that does one job at a time, in a worker process on its node."""

    def __init__(self, setup: Callable[[], Callable], limits: Limits) -> None:
        self._notices: list[str] = []
        self._pool = LocalPool(setup, 1, limits, self._notices.append)

    def ready(self) -> str:
        """Address of the actor's node."""
        return ray.util.get_node_ip_address()

    def do(self, name: Hashable, job: object) -> Report:
        """Carries out one job, as often as its limits allow."""
        self._pool.submit(name, job)
        try:
            while not (events := self._pool.wait()):
                pass
            event: Done | Lost | WorkerFailed = events[0]
        except WorkerFailed as failure:
            event = failure
        notices = tuple(self._notices)
        self._notices.clear()
        return Report(event, notices)

    def close(self) -> None:
        """Ends the worker process."""
        self._pool.close()


@dataclass(eq=False)
class _Job(Generic[J]):
    name: Hashable
    content: J
    losses: int = 0


@dataclass(eq=False)
class _Actor(Generic[J]):
    """An actor as the pool sees it."""

    handle: ActorHandle
    answer: ObjectRef | None  # to `ready`, then to `do`
    node: str = ""  # empty until it is ready
    job: _Job[J] | None = None


@dataclass
class RayPool(WorkerPool[J, R]):
    """Workers on the nodes of the cluster that `connect` has joined."""

    def __post_init__(self) -> None:
        self._actors: list[_Actor[J]] = []
        self._queue: deque[_Job[J]] = deque()
        self._failed_starts = 0
        self._without_node_since: float | None = None

    @property
    def busy(self) -> int:
        return len(self._queue) + sum(actor.job is not None for actor in self._actors)

    def submit(self, name: Hashable, job: J) -> None:
        self._queue.append(_Job(name, job))
        self._assign()

    def wait(self, timeout: float = 1.0) -> list[Done[R] | Lost]:
        ended: list[Done[R] | Lost] = []
        actors = {actor.answer: actor for actor in self._actors if actor.answer is not None}
        answered, _ = ray.wait(list(actors), num_returns=1, timeout=timeout)
        for answer in answered:
            ended += self._receive(actors[answer], answer)
        self._assign()
        self._notice_without_node()
        return ended

    def close(self) -> None:
        idle = [actor for actor in self._actors if actor.node and actor.job is None]
        ray.wait(
            [actor.handle.close.remote() for actor in idle] or [ray.put(None)],
            num_returns=max(len(idle), 1),
            timeout=CLOSE_SECONDS,
        )
        for actor in self._actors:
            ray.kill(actor.handle)
        self._actors.clear()
        self._queue.clear()

    def _assign(self) -> None:
        """Jobs go to actors that are ready: one that waits for a node must hold nothing up."""
        while len(self._actors) < min(self.size, self.busy):
            self._actors.append(self._start())
        for actor in self._actors:
            if self._queue and actor.node and actor.job is None:
                actor.job = self._queue.popleft()
                actor.answer = actor.handle.do.remote(actor.job.name, actor.job.content)

    def _start(self) -> _Actor[J]:
        # Ray must not restart it: it would run a job again without anybody counting.
        kind = ray.remote(num_cpus=1, max_restarts=0, max_task_retries=0)(WorkerActor)
        handle = kind.remote(self.setup, self.limits)
        return _Actor(handle, handle.ready.remote())  # type: ignore[arg-type] - a proxy is a handle

    def _notice_without_node(self) -> None:
        if any(actor.node for actor in self._actors) or not self._actors:
            self._without_node_since = None
        elif self._without_node_since is None:
            self._without_node_since = time.monotonic()
        elif time.monotonic() - self._without_node_since > IDLE_NOTICE:
            self.notice("the cluster has given no CPU yet; still waiting for one")
            self._without_node_since = time.monotonic()

    def _receive(self, actor: _Actor[J], answer: ObjectRef) -> list[Done[R] | Lost]:
        actor.answer = None
        try:
            message = ray.get(answer)
        except exceptions.RayTaskError as error:  # its own code: another rtphys, or a bug
            raise WorkerFailed(f"a Ray worker failed: {error.cause}", 70, str(error)) from error
        except exceptions.RayError as error:  # it died, or its answer was lost with its node
            self._handle_loss(actor, error)
            return []
        if isinstance(message, str):
            actor.node, self._failed_starts = message, 0
            return []
        assert isinstance(message, Report)
        for notice in message.notices:
            self.notice(f"{actor.node}: {notice}")
        actor.job = None
        if isinstance(message.event, WorkerFailed):
            raise message.event
        return [message.event]

    def _handle_loss(self, actor: _Actor[J], error: exceptions.RayError) -> None:
        """Starts the actor's job again elsewhere. A lost node is no verdict on the job."""
        self._actors.remove(actor)
        ray.kill(actor.handle)  # if only its answer was lost
        cause = str(error).strip().splitlines()[0] if str(error).strip() else type(error).__name__
        job = actor.job
        if job is None:
            self.notice(f"lost a worker that was starting: {cause}")
            self._failed_starts += 1
            if self._failed_starts >= START_TRIES:
                raise WorkerFailed(f"Ray workers die while they start: {error}", 70, "") from error
            return
        self.notice(f"lost a worker on {actor.node} with {job.name}: {cause}")
        job.losses += 1
        if job.losses > LOSSES:
            text = f"{job.name}: {job.losses} Ray workers were lost over it; the last: {error}"
            raise WorkerFailed(text, 70, "") from error
        self._queue.appendleft(job)
