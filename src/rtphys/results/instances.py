"""Certified lists: every seed that the expert tried, and whether it was feasible."""

from collections import Counter
from collections.abc import Mapping
from dataclasses import dataclass, replace

from rtphys.assets.embodiment import DEFAULT
from rtphys.data.episode import JSON

BENCHMARK = "benchmark_v2"
"""The folder below `manifests/` that holds the certified lists of this version."""

FIRST_SEED = 100_000
"""First seed of certification, as in RoboTwin's evaluation; training seeds start at 0."""

HASH_LENGTH = 16  # hexadecimal digits of a state hash that are stored


@dataclass(frozen=True)
class Slot:
    """Certification of one seed. A baseline that was not measured is None."""

    seed: int
    reason: str = ""  # why the expert failed; empty for a feasible seed
    state: str = ""  # first `HASH_LENGTH` digits of the demonstration's state hash
    replay: bool | None = None  # the demonstration's recorded actions succeed open loop
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
    embodiment: str = DEFAULT

    def to_json(self) -> dict[str, JSON]:
        """Plain values, nested as they are written to disk."""
        return {
            "domain": {"name": self.domain, "digest": self.domain_digest},
            "look": self.look_digest,
            "assets": self.assets,
            "versions": dict(sorted(self.versions.items())),
            **({} if self.embodiment == DEFAULT else {"embodiment": self.embodiment}),
        }


@dataclass(frozen=True)
class InstanceList:
    """Certified seeds of one task under one protocol; seeds are consecutive."""

    task: str
    protocol: str
    fingerprint: Mapping[str, JSON]  # `Fingerprint.to_json()`
    slots: tuple[Slot, ...]
    baselines: tuple[str, ...] = ()  # names of those that were measured

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
        """Number of infeasible seeds by reason."""
        return Counter(slot.reason for slot in self.slots if not slot.feasible)

    def first(self, episodes: int) -> "InstanceList":
        """The list up to its nth feasible seed: what an evaluation of n episodes uses."""
        kept: list[Slot] = []
        left = episodes
        for slot in self.slots:
            if not left:
                break
            kept.append(slot)
            left -= slot.feasible
        return replace(self, slots=tuple(kept))
