"""Reads one rule of a domain: a number, a name, a vector, or a mapping with one key."""

from collections.abc import Mapping

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
    """The distribution that `raw` (YAML or JSON) spells.

    Raises:
        BadValue: anything else; names file, key, value and the allowed spellings.
    """
    try:
        return _parse(key, raw, where)
    except (ValueError, TypeError, OverflowError) as error:
        raise BadValue(key, raw, f"{error}; {SPELLING}", where) from error


def _parse(key: str, raw: JsonRule, where: str) -> Distribution:
    if isinstance(raw, Mapping):
        if len(raw) != 1:
            raise ValueError("a rule has exactly one key")
        kind, argument = next(iter(raw.items()))
        return _mapping(key, str(kind), argument, where)
    if isinstance(raw, str):
        return Fixed(raw)
    if isinstance(raw, list | tuple):
        if len(raw) != 3:
            raise ValueError("a vector has three components")
        return Fixed(tuple(_number(x) for x in raw))
    return Fixed(_number(raw))


def _mapping(key: str, kind: str, argument: object, where: str) -> Distribution:
    if kind == "uniform":
        return Uniform(_interval(argument))
    if kind == "log_uniform":
        return LogUniform(_interval(argument))
    if kind == "choice":
        if not isinstance(argument, list) or not argument:
            raise ValueError("choice needs a list of at least one")
        options = tuple(o if isinstance(o, str) else _number(o) for o in argument)
        if len(set(options)) != len(options):
            raise ValueError("a choice is listed twice")
        return Choice(options)
    if kind == "direction" and argument == 3:
        return Direction()
    if kind == "same_as" and isinstance(argument, str):
        return SameAs(argument)
    if kind == "by" and isinstance(argument, Mapping) and len(argument) == 1:
        selector, branches = next(iter(argument.items()))
        if not isinstance(branches, Mapping) or not branches:
            raise ValueError(f"by {selector} needs a rule for each of its values")
        return By(
            str(selector),
            {str(n): _branch(f"{key}.{n}", rule, where) for n, rule in branches.items()},
        )
    raise ValueError(f"{kind!r} is no distribution that fits {argument!r}")


def _branch(key: str, raw: object, where: str) -> Distribution:
    rule = parse_rule(key, raw, where)
    if isinstance(rule, By | SameAs):
        raise ValueError("a branch of by holds a plain distribution")
    return rule


def _interval(argument: object) -> Interval:
    if not isinstance(argument, list | tuple) or len(argument) != 2:
        raise ValueError("a range is a list [low, high]")
    return Interval(_number(argument[0]), _number(argument[1]))


def _number(raw: object) -> float:
    if isinstance(raw, bool) or not isinstance(raw, int | float):
        raise ValueError(f"{raw!r} is not a number")
    value = float(raw)
    if value != value or value in (float("inf"), float("-inf")):
        raise ValueError(f"{raw!r} is not finite")
    return value
