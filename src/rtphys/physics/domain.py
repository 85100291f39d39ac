"""A domain: which attributes vary and by which rules, and how it draws an episode's physics."""

import hashlib
import json
from collections.abc import Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from itertools import islice, repeat
from pathlib import Path
from types import MappingProxyType
from typing import cast

from rtphys.core.errors import BadValue, Infeasible, UnknownName
from rtphys.core.seeds import Chance
from rtphys.physics.attribute import AnyAttribute, attribute, attributes
from rtphys.physics.distribution import (
    By,
    Choice,
    Deal,
    Direction,
    Distribution,
    Fixed,
    JsonRule,
    SameAs,
    extremes,
    parse_rule,
)
from rtphys.physics.gaze import MODES
from rtphys.physics.reach import MARK, Inside, keys_of, reach, split
from rtphys.physics.values import REDRAWS, Physics, Value

# Rules of a domain that has none of its own for the key; a domain may narrow them.
AUXILIARY: Mapping[str, Distribution] = MappingProxyType(
    {
        "camera_mode": Choice(MODES),  # how the head camera is displaced in this episode
        "camera_direction": Direction(),  # unit vector, or axis of rotation; camera frame
    }
)
CENTER_OF_MASS = "center_of_mass"
MAX_REDRAWS = 10_000


@dataclass(frozen=True)
class Domain:
    """Rules by attribute or auxiliary key. An attribute without a rule is nominal.

    A rule of one prop (`friction@puck`) is a part of its task, as the layout is: every protocol
    draws it, and none narrows it.
    """

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
        """By what an attribute or auxiliary is drawn; None where the attribute is nominal."""
        return self.drawn_by(key)[1] if key in self.rules or key in AUXILIARY else None

    def drawn_by(self, key: str) -> tuple[str, Distribution]:
        """Key and rule of the draw of what is not nominal: where it follows another, that one's."""
        rule = self.rules.get(key) or AUXILIARY[key]
        return (rule.source, self.rules[rule.source]) if isinstance(rule, SameAs) else (key, rule)

    def sample(
        self,
        seed: int,
        only: Collection[str] | None = None,
        overrides: Mapping[str, Value] | None = None,
        inside: Inside | None = None,
        task: str = "",
    ) -> Physics:
        """The physics of one episode.

        Every key draws from a stream of its own, `stream(seed, task, "physics", key)`. So `only`,
        `overrides` and new attributes never change the draws of the other keys.

        Args:
            only: attributes to vary; the others are nominal. None: all that have a rule. An
                attribute stands for its rules of single props, too.
            overrides: fixed values instead of draws; they may leave the domain, but not `valid`.
            inside: whether a centre of mass (3,) [m] lies inside every body it is for; it is drawn
                again from its own stream until it does. The test must depend on no drawn value,
                or holding that one would move the centre: see `smallest_scale`.
            task: whose streams; empty for those that all tasks share.

        Raises:
            UnknownName: `only` or `overrides` names no attribute.
            BadValue: an override that no simulator could have, or camera values that exclude
                each other.
            Infeasible: "invalid_physics" if no centre of mass fits.
        """
        held, chance, known = overrides or {}, Chance(seed, task), attributes()
        check_overrides(held)
        active = self._active(only, held, known)
        drawn = [key for key in active if key not in held]
        values: dict[str, Value] = {key: a.nominal for key, a in known.items()}
        values |= dict.fromkeys(AUXILIARY) | {REDRAWS: 0}
        # The draws of a camera's pose belong together: a mode is nothing without its direction.
        needed = any(known[split(key)[0]].auxiliary for key in active)
        needed |= any(isinstance(self.drawn_by(key)[1], By) for key in drawn)
        for key in AUXILIARY if needed or held.keys() & AUXILIARY.keys() else ():
            if key in held:
                values[key] = held[key]
                continue
            rule = self.rules.get(key, AUXILIARY[key])
            if isinstance(rule, Choice):
                rule = Choice(tuple(self._compatible(key, rule, active, held)))
            values[key] = rule.draw(chance.stream("physics", key), 1)
        values |= {key: held[key] for key in active if key in held}
        values |= {key: next(self._draws(key, values, chance)) for key in drawn}
        if inside is not None:
            sources = [self.drawn_by(key)[0] for key in keys_of(CENTER_OF_MASS, drawn)]
            for source in dict.fromkeys(sources):
                centre, redraws = self._center_of_mass(source, active, values, inside, chance)
                for key in self._alike(source):
                    if key in drawn:
                        values |= {key: centre, key.replace(CENTER_OF_MASS, REDRAWS): redraws}
        return Physics(values, active)

    def _active(
        self, only: Collection[str] | None, held: Mapping[str, Value], known: Collection[str]
    ) -> list[str]:
        """Attributes that an episode sets, drawn or held, sorted."""
        varied = {key for key in self.keys if split(key)[0] in known}
        if only is not None:
            for key in only:
                attribute(key)
                if key not in held and not self._named(key):
                    raise UnknownName(f"attribute of domain {self.name}", key, varied)
            varied = {rule for key in only for rule in self._named(key)}
        return sorted(varied | (held.keys() - AUXILIARY.keys()))

    def _named(self, key: str) -> list[str]:
        """Keys of the rules that a key stands for: its own, and for an attribute all of it."""
        return [rule for rule in self.keys if key in (rule, split(rule)[0])]

    def _compatible(
        self, selector: str, rule: Choice, active: Sequence[str], held: Mapping[str, Value]
    ) -> list[str]:
        """Options of `selector` that fit the held values and let an active attribute differ from 0.

        Examples: varying `camera_distance` alone never draws mode rotate; holding it at 0.05
        needs mode orbit. A value that no branch allows goes with the widest that is not fixed.

        Raises `BadValue`: held values that no option allows together.
        """
        options, branches = [str(o) for o in rule.options], dict[str, Mapping[str, Distribution]]()
        for key in active:
            by = self.rules.get(key)
            if isinstance(by, By) and by.selector == selector:
                branches[key] = by.branches
        for key in sorted(branches.keys() & held.keys()):
            own = branches[key]
            fitting = [o for o in options if held[key] in own[o]]
            if not fitting:
                wide = [o for o in options if not isinstance(own[o], Fixed)]
                reach = [max(x for x in extremes(own[o]) if isinstance(x, float)) for o in wide]
                fitting = [o for o, far in zip(wide, reach, strict=True) if far == max(reach)]
            if not fitting:
                others = ", ".join(sorted(branches.keys() & held.keys() - {key}))
                raise BadValue(key, held[key], f"no {selector} has it together with {others}")
            options = fitting

        def moves(key: str, option: str) -> bool:
            if held.get(key) is not None:
                return held[key] != 0.0
            return not isinstance(branches[key][option], Fixed)

        return [o for o in options if any(moves(key, o) for key in branches)] or options

    def _draws(self, key: str, values: Mapping[str, Value], chance: Chance) -> Iterator[Value]:
        """Values for a key, one after the other; of its auxiliaries, `values` holds this episode's.

        One that follows another draws from that one's stream: the same value, unless it is held.
        """
        source, rule = self.drawn_by(key)
        size = attribute(split(key)[0]).size
        if isinstance(rule, By):
            rule = rule.branches[str(values[rule.selector])]
        if isinstance(rule, Deal):
            yield from rule.draws(chance.stream("physics", rule.source), size)
        rng = chance.stream("physics", source)
        while True:
            yield rule.draw(rng, size)

    def _alike(self, source: str) -> list[str]:
        """Keys of the rules that draw as `source` does: itself, and what follows it."""
        return [key for key in self.keys if self.drawn_by(key)[0] == source]

    def _center_of_mass(
        self,
        key: str,
        active: Sequence[str],
        values: Mapping[str, Value],
        inside: Inside,
        chance: Chance,
    ) -> tuple[Value, int]:
        """The first draw that lies inside every body that it is for, and what came before it.

        Those that follow it count, held ones too: to hold one moves no other.
        """
        reaches = [reach(own, active) for own in self._alike(key)]
        for redraws, value in enumerate(islice(self._draws(key, values, chance), MAX_REDRAWS)):
            assert isinstance(value, tuple)
            fits = [inside(value, bodies) for bodies in reaches]  # all asked: `after` counts calls
            if all(fits):
                return value, redraws
        none = f"no {key} of {MAX_REDRAWS} lies inside every dynamic body"
        raise Infeasible("invalid_physics", none)

    @property
    def smallest_scale(self) -> float:
        """The least `object_scale` that it draws: a centre of mass must lie inside even then.

        Tested at the episode's own scale, the draw of one would depend on the draw of the other.
        """
        if "object_scale" not in self.rules:
            return 1.0
        return min(x for x in extremes(self.drawn_by("object_scale")[1]) if isinstance(x, float))

    @property
    def by_prop(self) -> "Domain":
        """The part of it that a protocol without physics draws: the rules of single props."""
        return self.of(())

    def of(self, keys: Collection[str]) -> "Domain":
        """The part of it that varies these attributes; each keeps its stream, so its draws.

        Rules of single props stay, for the task is nothing without them.

        What follows another attribute (`same_as`) that is left out has that one's rule itself.
        Raises `UnknownName`: it has no rule for one of them.
        """
        kept = {k: rule for k, rule in self.rules.items() if k in AUXILIARY or MARK in k}
        for key in keys:
            if not self._named(key):
                raise UnknownName(f"attribute of domain {self.name}", key, self.keys)
            if key in self.rules:
                kept[key] = self.rules[key]
        for key, rule in kept.items():
            if isinstance(rule, SameAs) and rule.source not in kept:
                kept[key] = self.rules[rule.source]
        sources = {key: source for key, source in self.sources.items() if key in kept}
        return replace(self, rules=kept, sources=sources)

    def narrowed(self, share: float) -> "Domain":
        """Every range drawn towards the nominal value, to this share of its width.

        The same seed draws the same point of the narrower range. A quantity whose nominal value is
        the asset's own (`object_joint_damping`) goes towards the lower end of its range. A domain
        that was narrowed before, as a manifest stores it, stays as it is.
        """
        if self.width < 1:
            return self
        known = attributes()
        rules = {  # auxiliary keys and single props are not among them
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

        Raises `BadValue`: a rule that cannot be read.
        """
        rules, sources = (
            cast(Mapping[str, JsonRule], part if isinstance(part, Mapping) else {})
            for part in (data.get("rules"), data.get("sources"))
        )
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


def check_overrides(overrides: Mapping[str, Value]) -> None:
    """Raise if an override is no value of its attribute or auxiliary key.

    Raises `UnknownName`: no such key; `BadValue`: outside what the simulator can do.
    """
    for key, value in overrides.items():
        if key not in AUXILIARY:
            check_key(key).check(value, prop=split(key)[1])
        elif value not in AUXILIARY[key]:
            raise BadValue(key, value, f"it is {AUXILIARY[key]}")


def check_key(key: str, where: str | Path = "") -> AnyAttribute:
    """The attribute of a key that is not auxiliary. Raises `UnknownName`, as `attribute`."""
    return attribute(key, where, AUXILIARY)


def after(redraws: Mapping[str, int]) -> Inside:
    """An `inside` for `Domain.sample` that rejects so many draws first, without geometry.

    Args:
        redraws: `center_of_mass_redraws`, or that of one prop, as `Physics` has them.
    """
    left = {split(key)[1]: repeat(False, count) for key, count in redraws.items()}
    return lambda _, reach: next(left.get(reach.prop, repeat(True, 1)), True)
