"""A study whose results are known beforehand."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

from rtphys.campaign.series import Series, Study, Tally
from rtphys.campaign.workers.pool import Lost


@dataclass(frozen=True)
class Outcome:
    """Result of one seed; a reason keeps it from counting."""

    seed: int
    reason: str = ""


@dataclass
class Numbers(Study[int, Outcome]):
    """Every third seed is bad."""

    refused: Mapping[int, str] = field(default_factory=dict)  # seed -> why its commit halts all
    elsewhere: frozenset[int] = frozenset()  # seeds whose results were made elsewhere
    forgives: bool = False  # a seed that lost its workers gets a result of its own
    arrivals: list[int] = field(default_factory=list)
    commits: list[Outcome] = field(default_factory=list)
    jobs: list[int] = field(default_factory=list)
    closed: int = 0

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

    def lost(self, seed: int, loss: Lost) -> Outcome | str:
        return Outcome(seed, loss.reason) if self.forgives else f"seed {seed}: {loss.reason}"

    def close(self) -> None:
        self.closed += 1


def outcome(seed: int) -> Outcome:
    return Outcome(seed, "slipped" if seed % 3 == 2 else "")


def series_of(
    study: Numbers, wanted: int, seeds: Sequence[int] = range(10**6), owed: int = 0
) -> Series[int, Outcome]:
    return Series(study, Tally("numbers", wanted), seeds, owed)
