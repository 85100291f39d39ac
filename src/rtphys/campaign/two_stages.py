"""A pool of two kinds of workers: what the first make, the second finish, several at a time."""

from collections import deque
from collections.abc import Callable, Sequence
from functools import partial
from multiprocessing import connection
from typing import Generic, NamedTuple, TypeVar

from rtphys.campaign.local import LocalPool
from rtphys.campaign.pool import J, Job, R, WorkerError, WorkerFailure, WorkerPool

M = TypeVar("M")
AHEAD = 2  # groups a second worker that may wait for it: bounds the memory that they take


class _Made(NamedTuple, Generic[J, M, R]):
    job: Job[J, R]
    made: M


class TwoStagePool(WorkerPool[J, R], Generic[J, M, R]):
    """Gives what the first workers make to the second ones as soon as one of these is free: few at
    a time where these have little to do, and many where they have much.

    Args:
        first, second: pools of this machine; `second` are as good as each other.
        group: how many are given to a second worker at once, at most.
        done: the result of what needs no second worker; None: it needs one.
    """

    def __init__(
        self,
        first: LocalPool[J, M],
        second: Sequence[LocalPool[Sequence[M], Sequence[R]]],
        group: int,
        done: Callable[[M], R | None],
    ) -> None:
        self._first, self._second, self._group, self._done = first, second, group, done
        self._made = deque[_Made[J, M, R]]()
        self._alone = deque[_Made[J, M, R]]()  # of groups that failed: one of them is to blame
        self._ahead = AHEAD * group * sum(pool.size for pool in second)
        self.size, self.busy = first.size, 0
        self.notice = first.notice
        for pool in self._pools:
            pool.notice = lambda text: self.notice(text)

    @property
    def _pools(self) -> Sequence[LocalPool[J, M] | LocalPool[Sequence[M], Sequence[R]]]:
        return self._first, *self._second

    @property
    def room(self) -> int:
        return self._first.room if len(self._made) < self._ahead else 0

    def _begin(self, job: Job[J, R]) -> None:
        self._first.submit(job.name, job.content, partial(self._receive, job))

    def _receive(self, job: Job[J, R], made: M | WorkerFailure | WorkerError) -> None:
        if isinstance(made, WorkerFailure | WorkerError):
            job.end(made)
        elif (result := self._done(made)) is not None:
            job.end(result)
        else:
            self._made.append(_Made(job, made))

    def _hand_over(self) -> None:
        while self._alone or self._made:
            pool = max(self._second, key=lambda one: one.room)
            if not pool.room:
                return
            if self._alone:
                group = [self._alone.popleft()]
            else:
                group = [self._made.popleft() for _ in range(min(self._group, len(self._made)))]
            more = f" and {len(group) - 1} more" if len(group) > 1 else ""
            name, contents = group[0].job.name + more, [one.made for one in group]
            pool.submit(name, contents, partial(self._end, group))

    def _end(
        self, group: Sequence[_Made[J, M, R]], outcome: Sequence[R] | WorkerFailure | WorkerError
    ) -> None:
        if not isinstance(outcome, WorkerFailure | WorkerError):
            for one, result in zip(group, outcome, strict=True):
                one.job.end(result)
        elif len(group) > 1:
            self._alone.extend(group)
        else:
            group[0].job.end(outcome)

    def wait(self, timeout: float = 1.0) -> None:
        self._hand_over()
        connection.wait([pool.fileno() for pool in self._pools], timeout)
        for pool in self._pools:
            pool.wait(0.0)

    def __exit__(self, *error: object) -> None:
        for pool in self._pools:
            pool.__exit__(*error)
