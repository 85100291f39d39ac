"""A crew whose workers live on the nodes of a Ray cluster.

Each actor is a foreman: it keeps one worker process of its own, the same as on a single machine,
so a job that crashes, hangs or leaks ends in the same way here and there, and Ray's threads and
signal handlers never share a process with the simulator. What is left for this file are foremen
that vanish, with their node or alone: their jobs begin again elsewhere.
"""

import time
from collections import deque
from collections.abc import Callable, Hashable
from dataclasses import dataclass
from typing import Generic, TypeVar

import ray
from ray import ObjectRef, exceptions
from ray.actor import ActorHandle

from rtphys.campaign.workers.local import START_TRIES, Crew
from rtphys.campaign.workers.pool import Done, Limits, Lost, WorkerFailed, Workers

J = TypeVar("J")
R = TypeVar("R")

LOSSES = 10  # foremen that may vanish over one job; nodes do go, but not that often
IDLE_NOTICE = 30.0  # [s] without a single foreman, after which somebody should know
FAREWELL = 5.0  # [s] in which foremen may end their workers and sweep


@dataclass(frozen=True)
class Report:
    """What a foreman sends back."""

    event: Done | Lost | WorkerFailed
    notes: tuple[str, ...]  # deaths of its workers


class Foreman:
    """The actor: one job at a time, in a worker process on its node."""

    def __init__(self, setup: Callable[[], Callable], limits: Limits) -> None:
        self._notes: list[str] = []
        self._crew = Crew(setup, 1, limits, self._notes.append)

    def ready(self) -> str:
        """Where it is: the node's address."""
        return ray.util.get_node_ip_address()

    def do(self, name: Hashable, job: object) -> Report:
        """Carries out one job, as often as its limits allow."""
        self._crew.submit(name, job)
        try:
            while not (events := self._crew.wait()):
                pass
            event: Done | Lost | WorkerFailed = events[0]
        except WorkerFailed as failure:
            event = failure
        notes = tuple(self._notes)
        self._notes.clear()
        return Report(event, notes)

    def close(self) -> None:
        """Ends the worker."""
        self._crew.close()


@dataclass(eq=False)
class _Job(Generic[J]):
    name: Hashable
    what: J
    losses: int = 0


@dataclass(eq=False)
class _Hand(Generic[J]):
    """A foreman as the supervisor sees it."""

    actor: ActorHandle
    answer: ObjectRef | None  # to `ready`, then to `do`
    node: str = ""  # empty until it is ready
    job: _Job[J] | None = None


@dataclass
class RayCrew(Workers[J, R]):
    """Workers on the nodes of the cluster that `ray_cluster.connect` has joined."""

    def __post_init__(self) -> None:
        self._hands: list[_Hand[J]] = []
        self._queue: deque[_Job[J]] = deque()
        self._failed_starts = 0
        self._lonely_since: float | None = None

    # ---- what a supervisor says ------------------------------------------------------------

    @property
    def busy(self) -> int:
        return len(self._queue) + sum(hand.job is not None for hand in self._hands)

    def submit(self, name: Hashable, job: J) -> None:
        self._queue.append(_Job(name, job))
        self._assign()

    def wait(self, timeout: float = 1.0) -> list[Done[R] | Lost]:
        found: list[Done[R] | Lost] = []
        hands = {hand.answer: hand for hand in self._hands if hand.answer is not None}
        answered, _ = ray.wait(list(hands), num_returns=1, timeout=timeout)
        for answer in answered:
            found += self._hear(hands[answer], answer)
        self._assign()
        self._watch()
        return found

    def close(self) -> None:
        ready = [hand for hand in self._hands if hand.node and hand.job is None]
        ray.wait(
            [hand.actor.close.remote() for hand in ready] or [ray.put(None)],
            num_returns=max(len(ready), 1),
            timeout=FAREWELL,
        )
        for hand in self._hands:
            ray.kill(hand.actor)
        self._hands.clear()
        self._queue.clear()

    # ---- foremen ---------------------------------------------------------------------------

    def _assign(self) -> None:
        """Jobs go to foremen that are there: one that waits for a node must hold nothing up."""
        while len(self._hands) < min(self.size, self.busy):
            self._hands.append(self._hire())
        for hand in self._hands:
            if self._queue and hand.node and hand.job is None:
                hand.job = self._queue.popleft()
                hand.answer = hand.actor.do.remote(hand.job.name, hand.job.what)

    def _hire(self) -> _Hand[J]:
        # Never restarted by Ray: it would run a job again without anybody counting.
        kind = ray.remote(num_cpus=1, max_restarts=0, max_task_retries=0)(Foreman)
        actor = kind.remote(self.setup, self.limits)
        return _Hand(actor, actor.ready.remote())  # type: ignore[arg-type] - a proxy is a handle

    def _watch(self) -> None:
        if any(hand.node for hand in self._hands) or not self._hands:
            self._lonely_since = None
        elif self._lonely_since is None:
            self._lonely_since = time.monotonic()
        elif time.monotonic() - self._lonely_since > IDLE_NOTICE:
            self.notice("the cluster has given no CPU yet; still waiting for one")
            self._lonely_since = time.monotonic()

    # ---- what a foreman says ---------------------------------------------------------------

    def _hear(self, hand: _Hand[J], answer: ObjectRef) -> list[Done[R] | Lost]:
        hand.answer = None
        try:
            said = ray.get(answer)
        except exceptions.RayTaskError as error:  # its own code: another rtphys, or a bug
            raise WorkerFailed(f"a Ray worker failed: {error.cause}", 70, str(error)) from error
        except exceptions.RayError as error:  # it died, or its answer was lost with its node
            return self._bury(hand, error)
        if isinstance(said, str):
            hand.node, self._failed_starts = said, 0
            return []
        assert isinstance(said, Report)
        for note in said.notes:
            self.notice(f"{hand.node}: {note}")
        hand.job = None
        if isinstance(said.event, WorkerFailed):
            raise said.event
        return [said.event]

    def _bury(self, hand: _Hand[J], error: exceptions.RayError) -> list[Done[R] | Lost]:
        """Its job begins again elsewhere. It is never given up: a lost node is no verdict."""
        self._hands.remove(hand)
        ray.kill(hand.actor)  # if only its answer was lost
        told = str(error).strip().splitlines()[0] if str(error).strip() else type(error).__name__
        job = hand.job
        if job is None:
            self.notice(f"lost a worker that was starting: {told}")
            self._failed_starts += 1
            if self._failed_starts >= START_TRIES:
                raise WorkerFailed(f"Ray workers die while they start: {error}", 70, "") from error
            return []
        self.notice(f"lost a worker on {hand.node} with {job.name}: {told}")
        job.losses += 1
        if job.losses > LOSSES:
            text = f"{job.name}: {job.losses} Ray workers were lost over it; the last: {error}"
            raise WorkerFailed(text, 70, "") from error
        self._queue.appendleft(job)
        return []
