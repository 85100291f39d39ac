"""A series whose results are known beforehand, and who hears what becomes of it."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from rtphys.campaign.pool import WorkerFailure
from rtphys.campaign.series import Listener, Progress, Series


@dataclass(frozen=True)
class Outcome:
    """Result of one seed; a reason keeps it from counting."""

    seed: int
    reason: str = ""


class Numbers(Series[int, Outcome]):
    """Every third seed is bad.

    Args:
        refused: seed -> why its commit halts all.
        elsewhere: seeds whose results were made elsewhere.
        forgives: a seed that lost its workers gets a result of its own.
    """

    def __init__(
        self,
        progress: Progress,
        seeds: Sequence[int] = range(10**6),
        owed: int = 0,
        refused: Mapping[int, str] = {},
        elsewhere: frozenset[int] = frozenset(),
        forgives: bool = False,
    ) -> None:
        super().__init__(progress, seeds, owed)
        self.refused, self.elsewhere, self.forgives = refused, elsewhere, forgives
        self.arrivals: list[int] = []
        self.commits: list[Outcome] = []
        self.jobs: list[int] = []
        self.dropped_seeds: list[int] = []
        self.closed = 0

    @property
    def committed(self) -> list[int]:
        return [outcome.seed for outcome in self.commits]

    def job(self, seed: int) -> int:
        self.jobs.append(seed)
        return seed

    def reason(self, result: Outcome) -> str:
        return result.reason

    def arrived(self, seed: int, result: Outcome) -> Outcome:
        self.arrivals.append(seed)
        return result

    def commit(self, seed: int, result: Outcome) -> str:
        assert result.seed == seed
        assert not self.closed
        if seed in self.refused:
            return self.refused[seed]
        self.commits.append(result)
        return ""

    def known(self, seed: int) -> Outcome | None:
        return outcome(seed) if seed in self.elsewhere else None

    def lost(self, seed: int, loss: WorkerFailure) -> Outcome | str:
        return Outcome(seed, loss.reason) if self.forgives else f"seed {seed}: {loss.reason}"

    def dropped(self, seed: int) -> None:
        self.dropped_seeds.append(seed)

    def close(self) -> None:
        self.closed += 1


class Ears(Listener):
    """Remembers what it hears."""

    def __init__(self) -> None:
        self.progresses: Sequence[Progress] = []
        self.ticks = 0
        self.notices: list[str] = []

    def started(self, progresses: Sequence[Progress]) -> None:
        self.progresses = progresses

    def ticked(self) -> None:
        self.ticks += 1

    def noticed(self, text: str) -> None:
        self.notices.append(text)


def outcome(seed: int) -> Outcome:
    return Outcome(seed, "slipped" if seed % 3 == 2 else "")


def numbers(wanted: int, seeds: Sequence[int] = range(10**6), **more) -> Numbers:
    return Numbers(Progress("numbers", wanted), seeds, **more)
