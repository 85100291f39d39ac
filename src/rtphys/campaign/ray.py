"""A worker pool on the nodes of a Ray cluster.

Each actor keeps one worker process of its own, as on a single machine, so that Ray's threads and
signal handlers never share a process with the simulator. Left for this file are actors that vanish,
with their node or alone: their jobs begin again elsewhere.
"""

# pyright: basic
# Ray tells no types.

import logging
import os
import signal
import time
from collections import deque
from dataclasses import dataclass
from typing import Any

import ray
from ray import ObjectRef, exceptions

from rtphys.campaign.local import LocalPool, OutsideTrouble
from rtphys.campaign.pool import CannotStart, J, Job, R, WorkerError, WorkerPool
from rtphys.core.errors import RtphysError

MAX_LOSSES = 10  # actors that may vanish over one job; nodes do go, but not that often
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

    Raises `NoCluster`: with the cure.
    """
    os.environ.update({**SETTINGS, **os.environ})
    if not ray.is_initialized():
        more = {}
        if address == "local":
            store = {"object_store_memory": OBJECT_STORE}
            more = {"num_cpus": workers, **store, "include_dashboard": False}
        handler = signal.getsignal(signal.SIGTERM)
        try:
            ray.init(address or "auto", log_to_driver=False, logging_level=logging.ERROR, **more)
        except (ConnectionError, TimeoutError, ValueError, RuntimeError) as error:
            text = f"Ray does not start here: {_first_line(error)}"
            if address != "local":
                cure = "start one with `ray start --head`, or take address `local`"
                text = f"no usable Ray cluster at {address or 'hand'}: {_first_line(error)}; {cure}"
            raise NoCluster(text) from error
        finally:
            signal.signal(signal.SIGTERM, handler)  # Ray installs its own
    return workers or max(int(ray.cluster_resources().get("CPU", 1)), 1)


def _first_line(error: Exception) -> str:
    return (str(error).strip() or type(error).__name__).splitlines()[0]


# Ray must not restart it: it would run a job again without anybody counting.
@ray.remote(num_cpus=1, max_restarts=0, max_task_retries=0)
class WorkerActor(LocalPool[object, object]):
    """A Ray actor that does one job at a time, in a worker process on its node."""

    def ready(self) -> str:
        """Address of the actor's node."""
        return ray.util.get_node_ip_address()

    def do(self, name: str, job: object) -> tuple[object, list[str]]:
        """What comes of a job, or a `WorkerError`, and deaths of the worker process on the way."""
        outcomes, notices = list[object](), list[str]()
        self.notice = notices.append
        try:
            self.submit(name, job, outcomes.append)
            while not outcomes:
                self.wait()
        except CannotStart as failure:
            outcomes.append(failure)
        return outcomes[0], notices


@dataclass
class RayPool(WorkerPool[J, R]):
    """Workers on the nodes of the cluster that `connect` has joined."""

    def __post_init__(self) -> None:
        self._queue: deque[Job[J, R]] = deque()
        self._idle: list[tuple[Any, str]] = []  # with the addresses of their nodes
        # By the answer: to `ready` without node and job, then to `do`.
        self._busy: dict[ObjectRef, tuple[Any, str, Job[J, R] | None]] = {}
        self._alone_since = time.monotonic()

    def __exit__(self, *_: object) -> None:
        for worker in (*self._idle, *self._busy.values()):
            ray.kill(worker[0])  # its worker dies with it

    def _begin(self, job: Job[J, R]) -> None:
        self._queue.append(job)
        self._assign()

    def _assign(self) -> None:
        """Jobs go to actors that are ready: one that waits for a node must hold nothing up."""
        while len(self._idle) + len(self._busy) < self.busy:
            actor = WorkerActor.remote(self.setup, 1, self.limits)
            self._busy[actor.ready.remote()] = actor, "", None
        while self._idle and self._queue:
            (actor, node), job = self._idle.pop(), self._queue.popleft()
            self._busy[actor.do.remote(job.name, job.content)] = actor, node, job

    def wait(self, timeout: float = 1.0) -> None:
        answered, _ = ray.wait(list(self._busy), timeout=timeout)
        for answer in answered:
            self._receive(answer, *self._busy.pop(answer))
        self._assign()
        if self._idle or any(node for _, node, _ in self._busy.values()):
            self._alone_since = time.monotonic()
        elif time.monotonic() - self._alone_since > IDLE_NOTICE:
            self.notice("the cluster has given no CPU yet; still waiting for one")
            self._alone_since = time.monotonic()

    def _receive(self, answer: ObjectRef, actor: Any, node: str, job: Job[J, R] | None) -> None:
        try:
            message = ray.get(answer)
        except exceptions.RayError as error:
            ray.kill(actor)
            if isinstance(error, exceptions.RayTaskError):  # its own code: another rtphys, or a bug
                raise WorkerError(
                    f"a Ray worker failed: {error.cause}", trace=str(error)
                ) from error
            # It died, or its answer was lost with its node, which is no verdict on the job.
            where = f"on {node} with {job.name}" if job else "that was starting"
            self.notice(f"lost a worker {where}: {_first_line(error)}")
            if job is None:
                self.count_failed_start(f"Ray workers die while they start: {error}")
                return
            job.foreign_deaths += 1
            if job.foreign_deaths > MAX_LOSSES:
                job.end(OutsideTrouble(job.name, job.foreign_deaths, f"by {_first_line(error)}"))
                return
            self._queue.appendleft(job)
            return
        if job is None:
            self._idle.append((actor, message))
            self.failed_starts = 0
            return
        self._idle.append((actor, node))
        outcome, notices = message
        for text in notices:
            self.notice(f"{node}: {text}")
        if isinstance(outcome, CannotStart):
            raise outcome
        job.end(outcome)
