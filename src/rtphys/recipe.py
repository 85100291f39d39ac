"""What an episode is made from: names and numbers only, enough to make it again anywhere."""

from collections.abc import Mapping
from dataclasses import dataclass, field

from rtphys.errors import UnknownName
from rtphys.physics.domain import Domain
from rtphys.physics.load import domain_for_task
from rtphys.physics.values import Value
from rtphys.protocol import VisualRules, load_protocol

SPLITS = ("seen", "unseen")
"""Which pictures may lie on table and wall: those of demonstrations, or those of evaluation."""


@dataclass(frozen=True)
class Recipe:
    """One attempt. Equal recipes give equal episodes, bit for bit."""

    task: str
    seed: int
    protocol: str = "clean"
    only: tuple[str, ...] | None = None  # vary these attributes alone
    overrides: Mapping[str, Value] = field(default_factory=dict)  # held at these values
    embodiment: str = "aloha-agilex"
    split: str = "seen"  # of the pictures on table and wall

    def domain(self) -> Domain:
        """The task's own domain, or nothing at all under a protocol without physics.

        Raises:
            UnknownName: no such protocol.
        """
        return domain_for_task(self.task) if load_protocol(self.protocol).physics else NOMINAL

    def visual(self) -> VisualRules | None:
        """What its look may be; None: as in clean.

        Raises:
            UnknownName: no such protocol, or no such split.
        """
        if self.split not in SPLITS:
            raise UnknownName("texture split", self.split, SPLITS)
        return load_protocol(self.protocol).visual

    def to_json(self) -> dict[str, object]:
        return {
            "task": self.task,
            "seed": self.seed,
            "protocol": self.protocol,
            "only": None if self.only is None else list(self.only),
            "overrides": {
                k: list(v) if isinstance(v, tuple) else v for k, v in self.overrides.items()
            },
            "embodiment": self.embodiment,
            "split": self.split,
        }


NOMINAL = Domain("nominal", {})
