"""What an episode is made from: names and numbers only, enough to make it again anywhere."""

from collections.abc import Mapping
from dataclasses import dataclass, field

from rtphys.errors import UnknownName
from rtphys.physics.domain import Domain
from rtphys.physics.load import domain_for_task
from rtphys.physics.values import Value

PROTOCOLS: dict[str, str] = {
    "clean": "nothing varies but the layout",
    "phys_random": "the 13 physical attributes of the task's domain",
}
"""Protocol -> what it varies."""


@dataclass(frozen=True)
class Recipe:
    """One attempt. Equal recipes give equal episodes, bit for bit."""

    task: str
    seed: int
    protocol: str = "clean"
    only: tuple[str, ...] | None = None  # vary these attributes alone
    overrides: Mapping[str, Value] = field(default_factory=dict)  # held at these values
    embodiment: str = "aloha-agilex"

    def domain(self) -> Domain:
        """The task's own domain, or nothing at all under `clean`.

        Raises:
            UnknownName: no such protocol.
        """
        if self.protocol not in PROTOCOLS:
            raise UnknownName("protocol", self.protocol, PROTOCOLS)
        return domain_for_task(self.task) if self.protocol.startswith("phys") else NOMINAL

    def to_json(self) -> dict[str, object]:
        return {
            "task": self.task,
            "seed": self.seed,
            "protocol": self.protocol,
            "only": None if self.only is None else list(self.only),
            "overrides": {k: list(v) if isinstance(v, tuple) else v for k, v in self.overrides.items()},
            "embodiment": self.embodiment,
        }


NOMINAL = Domain("nominal", {})
