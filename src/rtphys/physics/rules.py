"""Parses one rule of a domain: a number, a name, a vector, or a mapping with one key."""

from collections.abc import Mapping
from typing import cast

from rtphys.core.errors import BadValue
from rtphys.physics.distribution import (
    By,
    Choice,
    Direction,
    Distribution,
    Fixed,
    JsonRule,
    LogUniform,
    SameAs,
    Uniform,
)
from rtphys.physics.interval import Interval

SPELLING = (
    "write a number, {uniform: [low, high]}, {log_uniform: [low, high]}, {choice: [a, b, ...]}, "
    "{same_as: key} or {by: {key: {value: rule, ...}}}"
)


def parse_rule(key: str, raw: JsonRule, where: str = "") -> Distribution:
    """The distribution that `raw`, a rule read from YAML or JSON, describes.

    Raises:
        BadValue: not a rule; names file, key, value and the ways to write a rule.
    """
    try:
        return _parse(key, raw, where)
    except (ValueError, TypeError, OverflowError) as error:
        raise BadValue(key, raw, f"{error}; {SPELLING}", where) from error


def _parse(key: str, raw: JsonRule, where: str) -> Distribution:
    if isinstance(raw, Mapping):
        entries = list(cast(Mapping[object, object], raw).items())
        if len(entries) != 1:
            raise ValueError("a rule has exactly one key")
        kind, argument = entries[0]
        return _mapping(key, str(kind), argument, where)
    if isinstance(raw, str):
        return Fixed(raw)
    if isinstance(raw, list | tuple):
        parts = cast(list[object], raw)
        if len(parts) != 3:
            raise ValueError("a vector has three components")
        return Fixed(tuple(_number(part) for part in parts))
    return Fixed(_number(raw))


def _mapping(key: str, kind: str, argument: object, where: str) -> Distribution:
    if kind == "uniform":
        return Uniform(_interval(argument))
    if kind == "log_uniform":
        return LogUniform(_interval(argument))
    if kind == "choice":
        if not isinstance(argument, list) or not argument:
            raise ValueError("choice needs a list of at least one")
        options = tuple(
            o if isinstance(o, str) else _number(o) for o in cast(list[object], argument)
        )
        if len(set(options)) != len(options):
            raise ValueError("a choice is listed twice")
        return Choice(options)
    if kind == "direction" and argument == 3:
        return Direction()
    if kind == "same_as" and isinstance(argument, str):
        return SameAs(argument)
    if kind == "by" and isinstance(argument, Mapping):
        entries = list(cast(Mapping[object, object], argument).items())
        if len(entries) == 1:
            return _by(key, *entries[0], where)
    raise ValueError(f"{kind!r} is no distribution that fits {argument!r}")


def _by(key: str, selector: object, branches: object, where: str) -> By:
    if not isinstance(branches, Mapping) or not branches:
        raise ValueError(f"by {selector} needs a rule for each of its values")
    rules = cast(Mapping[object, object], branches)
    return By(
        str(selector), {str(n): _branch(f"{key}.{n}", rule, where) for n, rule in rules.items()}
    )


def _branch(key: str, raw: object, where: str) -> Distribution:
    rule = parse_rule(key, raw, where)
    if isinstance(rule, By | SameAs):
        raise ValueError("a branch of by holds a plain distribution")
    return rule


def _interval(argument: object) -> Interval:
    ends = cast(list[object], argument) if isinstance(argument, list | tuple) else []
    if len(ends) != 2:
        raise ValueError("a range is a list [low, high]")
    return Interval(_number(ends[0]), _number(ends[1]))


def _number(raw: object) -> float:
    if isinstance(raw, bool) or not isinstance(raw, int | float):
        raise ValueError(f"{raw!r} is not a number")
    value = float(raw)
    if value != value or value in (float("inf"), float("-inf")):
        raise ValueError(f"{raw!r} is not finite")
    return value
