"""EpisodeSpec: everything that decides an episode but its seed. Recipe: a spec and a seed."""

from collections.abc import Iterable, Mapping
from dataclasses import field, replace
from functools import cached_property
from typing import Annotated, cast

import numpy as np
from pydantic import PlainSerializer, PlainValidator, WithJsonSchema

from rtphys.assets.embodiment import DEFAULT
from rtphys.core.errors import BadValue
from rtphys.core.seeds import Chance
from rtphys.physics.domain import Domain
from rtphys.physics.load import domain_for_task, load_domain
from rtphys.physics.reach import Inside
from rtphys.physics.values import Physics, Value
from rtphys.spec.option import Option, RobotName, checked_dataclass, one_of
from rtphys.spec.protocol import (
    ONE_FACTOR,
    PAPER,
    VisualRandomization,
    load_protocol,
    protocol_names,
)
from rtphys.spec.rules import Rules
from rtphys.spec.stored import CLOSED

# Which textures table and wall may have: those of demonstrations, or those of evaluation.
SPLITS = ("seen", "unseen")
NOMINAL = Domain("nominal", {})


def _domain(raw: object) -> Domain | None:
    """A domain as it is, by name or file, or as `Domain.to_json` wrote it; None for nothing."""
    if raw is None or isinstance(raw, Domain):
        return raw
    if isinstance(raw, Mapping):
        return Domain.from_json(cast(Mapping[str, object], raw))
    return load_domain(str(raw)) if raw else None


Ranges = Annotated[
    Domain | None,
    PlainValidator(_domain),
    PlainSerializer(lambda domain: None if domain is None else domain.to_json()),
    WithJsonSchema({"anyOf": [{"type": "object"}, {"type": "string"}, {"type": "null"}]}),
]


@checked_dataclass(frozen=True, config=CLOSED)
class EpisodeSpec:
    """What decides an episode but its seed. Equal specs and seeds give equal bits."""

    task: str = ""  # empty in a template of several tasks
    protocol: Annotated[
        str, Option("What varies. Default: phys_random_all; with `only`, its attributes alone.")
    ] = ""
    only: Annotated[
        tuple[str, ...] | None,
        Option("Vary these attributes alone (comma-separated); looks too if `protocol` says so."),
    ] = None
    overrides: Annotated[
        Mapping[str, Value], Option("key=value: hold an attribute at a value; repeatable.", "set")
    ] = field(default_factory=dict[str, Value])
    ranges: Annotated[
        Ranges, Option("Draw from this domain (name or file), not from the task's own.", "domain")
    ] = None
    split: Annotated[
        str, one_of("texture split", SPLITS), Option("seen or unseen textures of table and wall.")
    ] = "seen"
    recovery: Annotated[bool, Option("Keep episodes in which a load was lost and taken again.")] = (
        True
    )
    embodiment: RobotName = DEFAULT
    pair_tasks: Annotated[
        bool, Option("Draw the same physics and look of a seed in every task.")
    ] = False

    def __post_init__(self) -> None:
        # The order of options is no difference, and a manifest does not keep it.
        object.__setattr__(self, "overrides", dict(sorted(self.overrides.items())))
        if self.protocol:
            return
        if self.only is None:
            object.__setattr__(self, "protocol", PAPER)
        elif len(self.only) == 1 and f"{ONE_FACTOR}{self.only[0]}" in protocol_names():
            object.__setattr__(self, "protocol", f"{ONE_FACTOR}{self.only[0]}")
            object.__setattr__(self, "only", None)
        else:
            object.__setattr__(self, "protocol", "clean")

    @property
    def variation(self) -> str:
        """What varies, in one word: the protocol, and what is picked or held beside it.

        Such as `clean.only=friction` or `phys_random.friction=0.2`.
        """
        words = [self.protocol, *([] if self.only is None else [f"only={','.join(self.only)}"])]
        for key, value in self.overrides.items():
            parts = value if isinstance(value, tuple) else (value,)
            spelled = (part if isinstance(part, str) else f"{part:g}" for part in parts)
            words.append(f"{key}={','.join(spelled)}")
        return ".".join(words)

    @cached_property
    def domain(self) -> Domain:
        """What the protocol draws of `ranges`, else of the task's own domain.

        A protocol without physics draws what `only` picks, else the rules of single props. Raises
        `UnknownName`: no such protocol; its one attribute has no rule in the domain.
        """
        protocol = load_protocol(self.protocol)
        whole = self.ranges or domain_for_task(self.task)
        if self.only is None and not protocol.physics:
            part = whole.by_prop
            return part if part.keys else NOMINAL
        part = whole.of(protocol.only) if protocol.only else whole
        return part.narrowed(protocol.width) if protocol.width < 1 else part

    def visual(self) -> VisualRandomization | None:
        """Rules of the look; None where it is that of `clean`. Raises `UnknownName`."""
        return load_protocol(self.protocol).visual

    @property
    def rules(self) -> Rules:
        """What physics and looks are drawn by, resolved. Raises `UnknownName`: no such protocol."""
        shared = "" if self.pair_tasks else self.task
        return Rules(self.domain, self.visual(), self.only, self.overrides, shared)

    def draw(self, seed: int, inside: Inside | None = None) -> Physics:
        """The physics of one episode, as `Domain.sample` draws it."""
        return self.rules.draw(seed, inside)

    def under(self, protocol: str) -> "EpisodeSpec":
        """The same under another protocol; one without physics holds and picks no attribute."""
        if load_protocol(protocol).physics:
            return replace(self, protocol=protocol)
        return replace(self, protocol=protocol, only=None, overrides={}, ranges=None)

    def at(self, seed: int) -> "Recipe":
        """One episode of it."""
        return Recipe(self, seed)


@checked_dataclass(frozen=True, config=CLOSED)
class Recipe:
    """One attempt. Equal recipes give equal episodes, bit for bit."""

    spec: EpisodeSpec
    seed: int

    @property
    def task(self) -> str:
        """Name of the spec's task."""
        return self.spec.task

    @property
    def protocol(self) -> str:
        """Name of the spec's protocol."""
        return self.spec.protocol

    def stream(self, *name: str) -> np.random.Generator:
        """A generator of this task and seed that neither physics nor look draws from."""
        return Chance(self.seed, self.task).stream(*name)


def check_varies(ranges: Domain, protocols: Iterable[str]) -> None:
    """A domain needs a protocol that draws from it. Raises `BadValue`: none varies physics."""
    names = list(protocols)
    if not any(load_protocol(name).physics for name in names):
        raise BadValue("ranges", ranges.name, f"protocol {', '.join(names)} varies no physics")
