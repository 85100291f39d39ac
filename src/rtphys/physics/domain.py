"""A domain: which attributes vary and by which rules. `load.py` reads it, `sampling.py` draws."""

import hashlib
import json
from collections.abc import Callable, Collection, Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import cast

from rtphys.core.errors import BadValue, UnknownName
from rtphys.core.seeds import Chance
from rtphys.physics.auxiliary import AUXILIARY
from rtphys.physics.distribution import Distribution, JsonRule, SameAs
from rtphys.physics.registry import attributes
from rtphys.physics.rules import parse_rule
from rtphys.physics.sampling import Request, draw
from rtphys.physics.values import Physics, Value, Vector


@dataclass(frozen=True)
class Domain:
    """Rules by attribute or auxiliary key. An attribute without a rule is nominal."""

    name: str
    rules: Mapping[str, Distribution]
    sources: Mapping[str, str] = field(default_factory=dict[str, str])  # key -> domain of its rule
    why: str = ""  # the reason for these ranges, in words
    width: float = 1.0  # to what share of it every range was narrowed

    @cached_property
    def digest(self) -> str:
        """SHA-256 of the resolved rules: equal digests and seeds draw equal physics."""
        rules = {key: rule.to_json() for key, rule in self.rules.items()}
        text = json.dumps(rules, sort_keys=True, separators=(",", ":"))
        return hashlib.sha256(text.encode()).hexdigest()

    @property
    def keys(self) -> list[str]:
        """Attributes that this domain varies, sorted, without auxiliary keys."""
        return sorted(self.rules.keys() - AUXILIARY.keys())

    def rule(self, key: str) -> Distribution | None:
        """The rule of an attribute or auxiliary key; None where the attribute is nominal."""
        return self.rules.get(key, AUXILIARY.get(key))

    def sample(
        self,
        seed: int,
        only: Collection[str] | None = None,
        overrides: Mapping[str, Value] | None = None,
        inside: Callable[[Vector], bool] | None = None,
        task: str = "",
    ) -> Physics:
        """The physics of one episode.

        Every key draws from a stream of its own, `stream(seed, task, "physics", key)`. So `only`,
        `overrides` and new attributes never change the draws of the other keys.

        Args:
            seed: episode seed.
            only: attributes to vary; the others are nominal. None: all that have a rule.
            overrides: fixed values instead of draws; they may leave the domain, but not `valid`.
            inside: whether a centre of mass (3,) [m] lies inside every dynamic body; it is drawn
                again from its own stream until it does. The test may depend on `object_scale`:
                sample without it, read the scale, then sample again (see `hull.inside`).
            task: whose streams; empty for those that all tasks share.

        Raises:
            UnknownName: `only` or `overrides` names no attribute.
            BadValue: an override that no simulator could have, or camera values that exclude
                each other.
            Infeasible: "invalid_physics" if no centre of mass fits.
        """
        chance = Chance(seed, task)
        return draw(self.rules, Request(self.name, chance, only, overrides or {}, inside))

    def problems(self, physics: Physics, held: Collection[str] = ()) -> list[str]:
        """One sentence for each value that this domain cannot draw; `held` keys may be anything."""
        wrong: list[str] = []
        for key, attribute in attributes().items():
            if key in held or key not in physics:
                continue
            value = physics[key]
            if key not in physics.varied:
                if value != attribute.nominal:
                    wrong.append(f"{key} = {value!r} is not varied yet not nominal")
            elif not self._allows(key, value, physics, held):
                allowed = str(self.rule(key) or "nothing")
                wrong.append(f"{key} = {value!r} is outside {self.name}: {allowed}")
        return wrong

    def _allows(self, key: str, value: Value, physics: Physics, held: Collection[str]) -> bool:
        rule = self.rule(key)
        if isinstance(rule, SameAs):
            if rule.source in physics.varied and physics[rule.source] != value:
                return False
            return rule.source in held or value in self.rules[rule.source]
        return rule is not None and value in rule

    def of(self, keys: Collection[str]) -> "Domain":
        """The part of it that varies these attributes; each keeps its stream, so its draws.

        What follows another attribute (`same_as`) that is left out has that one's rule itself.

        Raises:
            UnknownName: it has no rule for one of them.
        """
        kept: dict[str, Distribution] = {k: r for k, r in self.rules.items() if k in AUXILIARY}
        for key in keys:
            if key not in self.keys:
                raise UnknownName(f"attribute of domain {self.name}", key, self.keys)
            rule = self.rules[key]
            if isinstance(rule, SameAs) and rule.source not in keys:
                rule = self.rules[rule.source]
            kept[key] = rule
        return replace(
            self, rules=kept, sources={k: v for k, v in self.sources.items() if k in kept}
        )

    def narrowed(self, share: float) -> "Domain":
        """Every range drawn towards the nominal value, to this share of its width.

        The same seed draws the same point of the narrower range. A quantity whose nominal value is
        the asset's own (`object_joint_damping`) goes towards the lower end of its range. A domain
        that was narrowed before, as a manifest stores it, stays as it is.
        """
        if self.width < 1:
            return self
        known = attributes()
        rules = {
            key: rule.narrowed(share, known[key].nominal) if key in known else rule
            for key, rule in self.rules.items()
        }
        return replace(self, rules=rules, width=share)

    def to_json(self) -> dict[str, object]:
        """The resolved domain as plain JSON, for a manifest."""
        return {
            "name": self.name,
            "digest": self.digest,
            "why": self.why,
            "rules": {key: rule.to_json() for key, rule in sorted(self.rules.items())},
            "sources": dict(sorted(self.sources.items())),
            **({"width": self.width} if self.width < 1 else {}),
        }

    @staticmethod
    def from_json(data: Mapping[str, object], where: str = "") -> "Domain":
        """Inverse of `to_json`. The digest is computed again: compare it with the stored one.

        Raises:
            BadValue: a rule that cannot be read.
        """
        rules, sources = _mapping(data.get("rules")), _mapping(data.get("sources"))
        width = data.get("width", 1.0)
        if isinstance(width, bool) or not isinstance(width, int | float) or not 0 <= width <= 1:
            raise BadValue("width", width, "a share from 0 to 1", where)
        return Domain(
            name=str(data.get("name", "")),
            rules={key: parse_rule(key, rules[key], where) for key in sorted(rules)},
            sources={key: str(domain) for key, domain in sources.items()},
            why=str(data.get("why", "")),
            width=float(width),
        )


def _mapping(raw: object) -> dict[str, JsonRule]:
    """A JSON mapping; empty if `raw` is none."""
    if not isinstance(raw, Mapping):
        return {}
    return {str(key): value for key, value in cast(Mapping[object, object], raw).items()}
