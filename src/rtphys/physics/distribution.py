"""Distributions of a domain's values, and how they are read from JSON or YAML."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from math import exp, isfinite, log
from typing import Protocol, cast

import numpy as np

from rtphys.core.errors import BadValue
from rtphys.physics.reach import MARK
from rtphys.physics.values import Interval, Value, Vector, components

JsonRule = object  # in JSON or YAML: a number, a name, a list or a mapping with one key


class Distribution(Protocol):
    """The rule by which a domain draws one key; its text names the allowed values."""

    def draw(self, rng: np.random.Generator, size: int) -> Value:
        """One value of `size` components, drawn independently; a number if `size` is 1."""
        ...

    def __contains__(self, value: object) -> bool:
        """Whether `value` could be drawn; for a vector, whether each component could."""
        ...

    def within(self, other: "Distribution") -> bool:
        """Whether `other` could draw every value that this rule can draw."""
        ...

    def narrowed(self, share: float, centre: Value) -> "Distribution":
        """The rule with every value moved towards `centre`, to this share of the distance."""
        ...

    def to_json(self) -> JsonRule: ...


@dataclass(frozen=True)
class Uniform:
    """Every number of an interval is equally likely."""

    interval: Interval

    def draw(self, rng: np.random.Generator, size: int) -> Value:
        drawn = rng.uniform(self.interval.low, self.interval.high, size)
        return float(drawn[0]) if size == 1 else tuple(float(x) for x in drawn)

    def __contains__(self, value: object) -> bool:
        return value in self.interval

    def within(self, other: Distribution) -> bool:
        low, high = self.interval.low, self.interval.high
        return low in other and high in other and (isinstance(other, Uniform) or low == high)

    def narrowed(self, share: float, centre: Value) -> Distribution:
        low, high = self.interval.low, self.interval.high
        about = _number(centre, low)
        return Uniform(Interval(_towards(about, low, share), _towards(about, high, share)))

    def to_json(self) -> JsonRule:
        return {"uniform": [self.interval.low, self.interval.high]}

    def __str__(self) -> str:
        return str(self.interval)


@dataclass(frozen=True)
class LogUniform(Uniform):
    """Uniform in the logarithm: a value from 0.1 to 1 is as likely as one from 1 to 10."""

    def __post_init__(self) -> None:
        if self.interval.low <= 0:
            raise ValueError("log_uniform needs a positive lower end")

    def draw(self, rng: np.random.Generator, size: int) -> Value:
        low, high = self.interval.low, self.interval.high
        exponents = rng.uniform(log(low), log(high), size)
        # exp(log(x)) may leave the interval by one rounding.
        drawn = [min(max(exp(e), low), high) for e in exponents]
        return drawn[0] if size == 1 else tuple(drawn)

    def narrowed(self, share: float, centre: Value) -> Distribution:
        low, high = self.interval.low, self.interval.high
        about = log(_number(centre, low) or low)
        return LogUniform(Interval(*(exp(_towards(about, log(end), share)) for end in (low, high))))

    def to_json(self) -> JsonRule:
        return {"log_uniform": [self.interval.low, self.interval.high]}

    def __str__(self) -> str:
        return f"{self.interval} log-uniform"


@dataclass(frozen=True)
class Fixed:
    """Always the same number, name or vector. A number stands for every component."""

    value: float | str | Vector

    def draw(self, rng: np.random.Generator, size: int) -> Value:
        return (self.value,) * size if size > 1 and isinstance(self.value, float) else self.value

    def __contains__(self, value: object) -> bool:
        parts = components(value)
        if isinstance(value, tuple) and isinstance(self.value, float):
            return all(part == self.value for part in parts)
        return value == self.value

    def within(self, other: Distribution) -> bool:
        return self.value in other

    def narrowed(self, share: float, centre: Value) -> Distribution:
        if isinstance(self.value, str):
            return self
        if isinstance(self.value, tuple):
            about = _number(centre, 0.0)
            return Fixed(tuple(_towards(about, x, share) for x in self.value))
        return Fixed(_towards(_number(centre, self.value), self.value, share))

    def to_json(self) -> JsonRule:
        return list(self.value) if isinstance(self.value, tuple) else self.value

    def __str__(self) -> str:
        return f"{self.value:g}" if isinstance(self.value, float) else str(self.value)


@dataclass(frozen=True)
class Choice:
    """One of several numbers or names, all equally likely."""

    options: tuple[float | str, ...]

    def draw(self, rng: np.random.Generator, size: int) -> Value:
        # By one uniform number per component, so that a narrower choice changes few draws.
        drawn = [self.options[int(u * len(self.options))] for u in rng.random(size)]
        return drawn[0] if size == 1 else tuple(float(x) for x in drawn)

    def __contains__(self, value: object) -> bool:
        return all(part in self.options for part in components(value))

    def within(self, other: Distribution) -> bool:
        return all(option in other for option in self.options)

    def narrowed(self, share: float, centre: Value) -> Distribution:
        about = _number(centre, min((o for o in self.options if isinstance(o, float)), default=0.0))
        moved = (o if isinstance(o, str) else _towards(about, o, share) for o in self.options)
        return Choice(tuple(moved))

    def to_json(self) -> JsonRule:
        return {"choice": list(self.options)}

    def __str__(self) -> str:
        return "one of " + ", ".join(str(Fixed(o)) for o in self.options)


@dataclass(frozen=True)
class Direction:
    """A unit vector (3,), uniformly distributed on the sphere."""

    def draw(self, rng: np.random.Generator, size: int) -> Value:
        v = rng.standard_normal(3)
        return tuple(float(x) for x in v / np.linalg.norm(v))

    def __contains__(self, value: object) -> bool:
        if len(components(value)) != 3:
            return False
        norm = float(np.linalg.norm(np.asarray(value, float)))
        return isfinite(norm) and abs(norm - 1) < 1e-9

    def within(self, other: Distribution) -> bool:
        return isinstance(other, Direction)

    def narrowed(self, share: float, centre: Value) -> Distribution:
        return self

    def to_json(self) -> JsonRule:
        return {"direction": 3}

    def __str__(self) -> str:
        return "any direction"


@dataclass(frozen=True)
class By:
    """A rule for each value of another key: `{by: {camera_mode: {orbit: ..., shift: ...}}}`."""

    selector: str
    branches: Mapping[str, Distribution]

    def draw(self, rng: np.random.Generator, size: int) -> Value:
        raise TypeError(f"the value of {self.selector} must choose a branch before the draw")

    def __contains__(self, value: object) -> bool:
        return any(value in branch for branch in self.branches.values())

    def within(self, other: Distribution) -> bool:
        if isinstance(other, By):
            return other.selector == self.selector and all(
                name in other.branches and rule.within(other.branches[name])
                for name, rule in self.branches.items()
            )
        return all(rule.within(other) for rule in self.branches.values())

    def narrowed(self, share: float, centre: Value) -> Distribution:
        return By(self.selector, {n: r.narrowed(share, centre) for n, r in self.branches.items()})

    def to_json(self) -> JsonRule:
        return {"by": {self.selector: {n: r.to_json() for n, r in self.branches.items()}}}

    def __str__(self) -> str:
        return "; ".join(f"{name}: {rule}" for name, rule in self.branches.items())


@dataclass(frozen=True)
class SameAs:
    """The same value as another key's, whose rule `Domain` asks and draws by."""

    source: str

    def draw(self, rng: np.random.Generator, size: int) -> Value:
        raise TypeError(f"take the value of {self.source} instead of drawing one")

    def __contains__(self, value: object) -> bool:
        return False

    def within(self, other: Distribution) -> bool:
        return self == other

    def narrowed(self, share: float, centre: Value) -> Distribution:
        return self  # its source is narrowed

    def to_json(self) -> JsonRule:
        return {"same_as": self.source}

    def __str__(self) -> str:
        return f"same as {self.source}"


@dataclass(frozen=True)
class Deal:
    """One of several rules, of which props that share them get a different one each.

    Which prop gets which is drawn once for all, from the stream of `source`.
    """

    source: str  # the key that names all of them: `friction@left_block,right_block`
    place: int  # of this prop among them
    rules: tuple[Distribution, ...]

    def draw(self, rng: np.random.Generator, size: int) -> Value:
        return next(self.draws(rng, size))

    def draws(self, rng: np.random.Generator, size: int) -> Iterator[Value]:
        """Values by the rule of this prop, one after the other."""
        order = rng.permutation(len(self.rules))
        while True:  # every prop draws by all rules, so that no two take the same numbers
            yield [rule.draw(rng, size) for rule in self.rules][int(order[self.place])]

    def __contains__(self, value: object) -> bool:
        return any(value in rule for rule in self.rules)

    def within(self, other: Distribution) -> bool:
        return self == other or all(rule.within(other) for rule in self.rules)

    def narrowed(self, share: float, centre: Value) -> Distribution:
        return self  # a part of its task, as all that single props have

    def to_json(self) -> JsonRule:
        rules = [rule.to_json() for rule in self.rules]
        return {"deal": {"source": self.source, "place": self.place, "rules": rules}}

    def __str__(self) -> str:
        return f"one of {', '.join(map(str, self.rules))}, each to another prop"


def _towards(centre: float, end: float, share: float) -> float:
    return centre + share * (end - centre) if share < 1 else end


def _number(centre: Value, otherwise: float) -> float:
    """The centre of one component: 0 for a vector's, `otherwise` where only the asset has one."""
    if isinstance(centre, tuple):
        return float(centre[0])
    return float(centre) if isinstance(centre, int | float) else otherwise


def narrows(child: Distribution, parent: Distribution) -> bool:
    """Whether a child domain may replace rule `parent` by `child`, which must allow no more.

    A child without branches must fit every branch of the parent's rule.
    """
    if isinstance(parent, By) and not isinstance(child, By):
        return all(child.within(branch) for branch in parent.branches.values())
    return child.within(parent)


def extremes(rule: Distribution) -> list[Value]:
    """The values to check in place of all: if an attribute allows these, it allows every draw."""
    if isinstance(rule, Uniform):
        return [rule.interval.low, rule.interval.high]
    if isinstance(rule, Choice):
        return list(rule.options)
    if isinstance(rule, By):
        return [value for branch in rule.branches.values() for value in extremes(branch)]
    if isinstance(rule, Deal):
        return [value for part in rule.rules for value in extremes(part)]
    return [rule.value] if isinstance(rule, Fixed) else []


SPELLING = (
    "write a number, {uniform: [low, high]}, {log_uniform: [low, high]}, {choice: [a, b, ...]}, "
    "{same_as: key}, {by: {key: {value: rule, ...}}}, or, for key@a,b, {deal: [rule, rule]}"
)


def parse_rule(key: str, raw: JsonRule, where: str = "") -> Distribution:
    """The distribution that `raw`, a rule read from YAML or JSON, describes.

    Raises `BadValue`: not a rule; names file, key, value and the ways to write a rule.
    """
    try:
        if isinstance(raw, str):
            return Fixed(raw)
        if isinstance(raw, Mapping):
            entries = list(cast(Mapping[object, object], raw).items())
            if len(entries) != 1:
                raise ValueError("a rule has exactly one key")
            return _parse(key, str(entries[0][0]), entries[0][1], where)
        if isinstance(raw, list | tuple):
            parts = cast(list[object], raw)
            if len(parts) != 3:
                raise ValueError("a vector has three components")
            return Fixed(tuple(_finite(part) for part in parts))
        return Fixed(_finite(raw))
    except (ValueError, TypeError, OverflowError) as error:
        raise BadValue(key, cast(object, raw), f"{error}; {SPELLING}", where) from error


def _parse(key: str, kind: str, argument: object, where: str) -> Distribution:
    match kind, argument:
        case "uniform" | "log_uniform", _:
            ends = cast(list[object], argument) if isinstance(argument, list | tuple) else []
            if len(ends) != 2:
                raise ValueError("a range is a list [low, high]")
            interval = Interval(_finite(ends[0]), _finite(ends[1]))
            return Uniform(interval) if kind == "uniform" else LogUniform(interval)
        case "choice", _:
            given = cast(list[object], argument) if isinstance(argument, list) else []
            if not given:
                raise ValueError("choice needs a list of at least one")
            options = tuple(o if isinstance(o, str) else _finite(o) for o in given)
            if len(set(options)) != len(options):
                raise ValueError("a choice is listed twice")
            return Choice(options)
        case "direction", 3:
            return Direction()
        case "same_as", str():
            return SameAs(argument)
        case "deal", _:
            given = cast(Mapping[str, object], argument if isinstance(argument, Mapping) else {})
            source, place, rules = given.get("source"), given.get("place"), given.get("rules")
            place = place if isinstance(place, int) else 0
            listed = cast(list[object], rules) if isinstance(rules, list) else []
            return _deal(str(source or key), place, listed, where)
        case "by", Mapping() if len(cast(Mapping[object, object], argument)) == 1:
            ((selector, rules),) = cast(Mapping[object, object], argument).items()
            if not isinstance(rules, Mapping) or not rules:
                raise ValueError(f"by {selector} needs a rule for each of its values")
            branches: dict[str, Distribution] = {}
            for name, rule in cast(Mapping[object, object], rules).items():
                branches[str(name)] = parse_rule(f"{key}.{name}", rule, where)
                if isinstance(branches[str(name)], By | SameAs):
                    raise ValueError("a branch of by holds a plain distribution")
            return By(str(selector), branches)
        case _:
            raise ValueError(f"{kind!r} is no distribution that fits {argument!r}")


def _deal(source: str, place: int, rules: list[object], where: str) -> Deal:
    props = source.partition(MARK)[2].split(",")
    if not len(props) == len(rules) > 1 or not 0 <= place < len(rules):
        raise ValueError("deal has as many rules as its key names props: key@a,b: {deal: [r, s]}")
    parsed = tuple(parse_rule(source, rule, where) for rule in rules)
    if any(isinstance(rule, By | SameAs | Deal) for rule in parsed):
        raise ValueError("a deal is of plain distributions")
    return Deal(source, place, parsed)


def _finite(raw: object) -> float:
    if isinstance(raw, bool) or not isinstance(raw, int | float):
        raise ValueError(f"{raw!r} is not a number")
    if not isfinite(raw):
        raise ValueError(f"{raw!r} is not finite")
    return float(raw)
