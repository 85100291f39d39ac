"""What a certified list says: every seed that was tried, and what came of it."""

from collections import Counter
from collections.abc import Mapping
from dataclasses import dataclass, replace

from rtphys.data.episode import JSON

FIRST_SEED = 100_000
"""Where certification begins. RoboTwin evaluates from here too; training seeds go up from 0."""

HASH_LENGTH = 16  # hexadecimal digits of a state hash that a list keeps


@dataclass(frozen=True)
class Slot:
    """One seed. Baselines are None where they were not asked for or cannot be."""

    seed: int
    reason: str = ""  # why the expert failed; empty: feasible
    state: str = ""  # of a feasible one: first digits of its demonstration's state hash
    replay: bool | None = None  # the demonstration's recorded actions alone succeed
    twin: bool | None = None  # the clean demonstration's actions succeed under this physics

    @property
    def feasible(self) -> bool:
        return not self.reason


@dataclass(frozen=True)
class Fingerprint:
    """Certification fingerprint: what decides which seeds are feasible.

    Equal fingerprints give equal lists.
    """

    domain: str  # name
    domain_digest: str  # of the resolved rules
    look_digest: str  # of the protocol's visual rules; empty without any
    assets: str  # digest of the pack
    versions: Mapping[str, str]

    def to_json(self) -> dict[str, JSON]:
        """Plain values, nested as they are written."""
        return {
            "domain": {"name": self.domain, "digest": self.domain_digest},
            "look": self.look_digest,
            "assets": self.assets,
            "versions": dict(sorted(self.versions.items())),
        }


@dataclass(frozen=True)
class InstanceList:
    """The seeds of one task under one protocol, from the first one upward without a gap."""

    task: str
    protocol: str
    fingerprint: Mapping[str, JSON]  # `Fingerprint.to_json()`
    slots: tuple[Slot, ...]
    baselines: tuple[str, ...] = ()  # which were measured

    @property
    def first_seed(self) -> int:
        return self.slots[0].seed if self.slots else FIRST_SEED

    @property
    def feasible(self) -> tuple[Slot, ...]:
        return tuple(slot for slot in self.slots if slot.feasible)

    @property
    def attempts(self) -> int:
        return len(self.slots)

    @property
    def rejected(self) -> Counter[str]:
        """Infeasible seeds by reason."""
        return Counter(slot.reason for slot in self.slots if not slot.feasible)

    def first(self, episodes: int) -> "InstanceList":
        """The list up to its nth feasible seed: what evaluating n episodes is about."""
        kept: list[Slot] = []
        left = episodes
        for slot in self.slots:
            if not left:
                break
            kept.append(slot)
            left -= slot.feasible
        return replace(self, slots=tuple(kept))
