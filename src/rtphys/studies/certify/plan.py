"""What to certify, and all that can be refused before any work is done."""

from dataclasses import dataclass, field
from pathlib import Path

from rtphys.campaign.workers.pool import Limits
from rtphys.core.errors import BadValue, UnknownName
from rtphys.results.instances import FIRST_SEED
from rtphys.setting.protocol import load_protocol
from rtphys.task.spec import Task, load_task

BASELINES = ("replay", "twin")


@dataclass(frozen=True)
class CertifyPlan:
    """One run of `certify`.

    Args:
        feasible: how many feasible seeds of each task and protocol.
        baselines: which to measure on each feasible seed: "replay", its recorded actions alone;
            "twin", under physics, the clean demonstration's actions. Each costs about as much
            as the attempt itself. A list that has others keeps them and gains these.
        most_attempts: of each list; then it stays shorter.
    """

    tasks: tuple[str, ...]
    protocols: tuple[str, ...]
    out: Path
    feasible: int = 100
    first_seed: int = FIRST_SEED
    baselines: tuple[str, ...] = BASELINES
    most_attempts: int = 1000
    workers: int = 1
    limits: Limits = field(default_factory=Limits)

    def check(self) -> dict[str, Task]:
        """The tasks by name.

        Raises:
            UnknownName, BadValue, BadFile: before any work is done.
        """
        for name in self.protocols:
            load_protocol(name)
        for name in self.baselines:
            if name not in BASELINES:
                raise UnknownName("baseline", name, BASELINES)
        least = {"feasible": 1, "first_seed": 0, "most_attempts": 1, "workers": 1}
        for key, bound in least.items():
            if getattr(self, key) < bound:
                raise BadValue(f"--{key.replace('_', '-')}", getattr(self, key), f">= {bound}")
        return {name: load_task(name) for name in self.tasks}


def measurable(baselines: tuple[str, ...], protocol: str) -> tuple[str, ...]:
    """Those that make sense under a protocol: without physics a twin would be the same world.

    Raises:
        UnknownName: no such protocol.
    """
    physics = load_protocol(protocol).physics
    return tuple(name for name in baselines if physics or name != "twin")
