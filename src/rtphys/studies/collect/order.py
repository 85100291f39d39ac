"""One task's attempts: which seeds to hand out, which results to wait for, when to stop."""

import math
from dataclasses import dataclass, field
from typing import NamedTuple

from rtphys.campaign.workers.pool import Done, Lost
from rtphys.data.faults import DatasetMismatch
from rtphys.data.staging import StagedEpisode
from rtphys.data.task_writer import TaskWriter
from rtphys.studies.collect.plan import BARREN, CollectPlan
from rtphys.studies.collect.remote import Sent, Shipped
from rtphys.studies.collect.tally import Tally
from rtphys.studies.collect.work import Job, Result, Results, rejection
from rtphys.task.spec import Task

LOOKAHEAD = 4  # results a worker may be ahead of the slowest: bounds what waits on the disk


class Name(NamedTuple):
    """An attempt."""

    task: str
    seed: int

    def __str__(self) -> str:
        return f"{self.task}, seed {self.seed}"


@dataclass
class Order:
    """One task under one plan, and under its twin if it has one: a writer each, in step.

    A kill between two commits leaves one writer ahead of the other; the seed is then tried again
    for the one that lacks it.
    """

    plan: CollectPlan
    task: Task
    writers: tuple[TaskWriter, ...]
    tally: Tally
    next_seed: int
    under_way: set[int] = field(default_factory=set)
    waiting: dict[int, Results] = field(default_factory=dict)  # for an earlier seed's result

    @staticmethod
    def open(plan: CollectPlan, task: Task, writers: tuple[TaskWriter, ...]) -> "Order":
        first = min(writer.next_seed for writer in writers)
        episodes, tried = min(w.episodes for w in writers), min(w.attempts for w in writers)
        tally = Tally(task.name, plan.share, episodes, tried, episodes, tried)
        order = Order(plan, task, writers, tally, first)
        order._give_up_if_hopeless()
        return order

    def wants(self, workers: int) -> bool:
        """Whether one more attempt should begin: as many as the missing episodes are worth."""
        tally = self.tally
        if self.over:
            return False
        most = self.plan.most_attempts
        if most is not None and self.next_seed >= self.plan.first_seed + most:
            return False
        if len(self.under_way) + len(self.waiting) >= LOOKAHEAD * workers:
            return False
        ready = sum(_accepted(results) for results in self.waiting.values())
        missing = tally.wanted - tally.episodes - ready
        return len(self.under_way) < math.ceil(missing / tally.rate)

    @property
    def step(self) -> int:
        """Between seeds of this shard."""
        return self.plan.stride[1]

    @property
    def over(self) -> bool:
        """Complete or given up; what still runs was begun to be on the safe side."""
        return self.tally.done or bool(self.tally.stopped)

    def begin(self) -> tuple[Name, Job]:
        seed = self.next_seed
        self.next_seed += self.step
        self.under_way.add(seed)
        folders = tuple(writer.staging(seed) for writer in self.writers)
        return Name(self.task.name, seed), Job(self.plan.recipes(self.task.name, seed), folders)

    def take(self, seed: int, event: Done[Sent] | Lost) -> None:
        """Files a result; counts all that are committed with it.

        Raises:
            DatasetMismatch: an attempt that one of two twins holds came out otherwise this time.
        """
        self.under_way.discard(seed)
        if self.over:
            return
        if isinstance(event, Done):
            results = self._landed(seed, event.result)
        else:
            recipes = self.plan.recipes(self.task.name, seed)
            results = tuple(rejection(one, event.reason, event.detail) for one in recipes)
        self.waiting[seed] = results
        before = self._committed
        for writer, result in zip(self.writers, results, strict=True):
            _record(writer, result)
        for committed in range(before, self._committed, self.step):
            self._count(self.waiting.pop(committed))
        self._give_up_if_hopeless()

    def _landed(self, seed: int, sent: Sent) -> Results:
        """Files from other machines are put where those of this one are."""
        return tuple(
            one.land(writer.staging(seed)) if isinstance(one, Shipped) else one
            for one, writer in zip(sent, self.writers, strict=True)
        )

    @property
    def _committed(self) -> int:
        """The lowest seed that some writer still waits for."""
        return min(writer.next_seed for writer in self.writers)

    def _count(self, results: Results) -> None:
        first = results[0]
        if isinstance(first, StagedEpisode):
            self.tally.accepted(first.frames)
        else:
            self.tally.rejected(first.reason)

    def _give_up_if_hopeless(self) -> None:
        tally, most = self.tally, self.plan.most_attempts
        if tally.done:
            return
        if tally.barren >= BARREN:
            tally.stopped = f"none of the last {tally.barren} attempts was accepted"
        elif most is not None and self._committed >= self.plan.first_seed + most:
            tally.stopped = f"{tally.attempts} attempts were made, the most that were allowed"


def _accepted(results: Results) -> bool:
    return isinstance(results[0], StagedEpisode)


def _record(writer: TaskWriter, result: Result) -> None:
    if result.seed >= writer.next_seed:
        writer.record(result)
    elif isinstance(result, StagedEpisode) != writer.accepted(result.seed):
        now = "accepted" if isinstance(result, StagedEpisode) else f"rejected ({result.reason})"
        clause = f"seed {result.seed} is {now} when its twin is made, and was not before"
        raise DatasetMismatch(writer.task_dataset.folder, [clause])
