"""What an episode is made from: names and numbers only, enough to make it again anywhere."""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field

from rtphys.core.errors import BadValue, UnknownName
from rtphys.physics.domain import Domain
from rtphys.physics.load import domain_for_task
from rtphys.physics.values import Value, plain_value
from rtphys.setting.protocol import VisualRules, load_protocol

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
    ranges: Domain | None = None  # instead of the task's own; whole, so that it travels along
    recovery: bool = True  # a load that is lost may be taken again, once

    def domain(self) -> Domain:
        """`ranges`, else the task's own domain; nothing at all under a protocol without physics.

        Raises:
            UnknownName: no such protocol.
        """
        if not load_protocol(self.protocol).physics:
            return NOMINAL
        return self.ranges or domain_for_task(self.task)

    def visual(self) -> VisualRules | None:
        """What its look may be; None: as in clean.

        Raises:
            UnknownName: no such protocol, or no such split.
        """
        if self.split not in SPLITS:
            raise UnknownName("texture split", self.split, SPLITS)
        return load_protocol(self.protocol).visual

    @staticmethod
    def from_json(stored: Mapping[str, object]) -> "Recipe":
        """Inverse of `to_json`.

        Raises:
            KeyError, ValueError: a key is missing, or a value is none.
            BadValue: a rule of its domain cannot be read.
        """
        only, held, ranges = (stored.get(key) for key in ("only", "overrides", "ranges"))
        return Recipe(
            task=str(stored["task"]),
            seed=int(str(stored["seed"])),
            protocol=str(stored["protocol"]),
            only=tuple(map(str, only)) if isinstance(only, list) else None,
            overrides={k: plain_value(v) for k, v in held.items()}
            if isinstance(held, dict)
            else {},
            embodiment=str(stored["embodiment"]),
            split=str(stored.get("split", "seen")),
            ranges=Domain.from_json(ranges) if isinstance(ranges, dict) else None,
            recovery=stored.get("recovery") is not False,
        )

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
            **({} if self.ranges is None else {"ranges": self.ranges.to_json()}),
            **({} if self.recovery else {"recovery": False}),
        }


def check_varies(ranges: Domain, protocols: Iterable[str]) -> None:
    """A domain of one's own needs a protocol that draws from it.

    Raises:
        UnknownName: no such protocol.
        BadValue: none of them varies physics.
    """
    named = [load_protocol(name) for name in protocols]
    if not any(one.physics for one in named):
        names = ", ".join(one.name for one in named)
        raise BadValue("domain", ranges.name, f"protocol {names} varies no physics")


NOMINAL = Domain("nominal", {})
