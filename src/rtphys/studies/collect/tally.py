"""How far the collection of one task is."""

from collections import Counter
from dataclasses import dataclass, field


@dataclass
class Tally:
    """Counts of what is committed; attempts that wait for an earlier seed are not in it."""

    task: str
    wanted: int
    episodes: int = 0
    attempts: int = 0
    found_episodes: int = 0  # of an earlier run
    found_attempts: int = 0
    frames: int = 0  # of this run
    rejections: Counter[str] = field(default_factory=Counter)  # of this run, by reason
    barren: int = 0  # rejections since the last episode
    stopped: str = ""  # why it was given up

    @property
    def done(self) -> bool:
        return self.episodes >= self.wanted

    @property
    def new_episodes(self) -> int:
        return self.episodes - self.found_episodes

    @property
    def new_attempts(self) -> int:
        return self.attempts - self.found_attempts

    @property
    def rate(self) -> float:
        """Expected share of accepted attempts, in (0, 1]; optimistic while little is known."""
        return (self.new_episodes + 1) / (self.new_attempts + 1)

    def accepted(self, frames: int) -> None:
        self.episodes += 1
        self.attempts += 1
        self.frames += frames
        self.barren = 0

    def rejected(self, reason: str) -> None:
        self.attempts += 1
        self.rejections[reason] += 1
        self.barren += 1
