"""Reads domains from YAML files, with inheritance, and values from texts such as `friction=0.2`."""

import re
from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import cast

from rtphys.core import library
from rtphys.core.errors import BadFile, BadValue, UnknownName, short_repr
from rtphys.core.untrusted import plain_name
from rtphys.physics.attribute import attribute
from rtphys.physics.distribution import (
    By,
    Choice,
    Distribution,
    SameAs,
    extremes,
    narrows,
    parse_rule,
)
from rtphys.physics.domain import AUXILIARY, Domain, check_key, check_overrides
from rtphys.physics.reach import MARK, split
from rtphys.physics.values import Value

FIELDS = ("extends", "why", "physics")


def load_domain(name: str | Path) -> Domain:
    """The domain of a name (in any library) or of a path to its file.

    Raises:
        UnknownName: no such domain, field or attribute; names the nearest match.
        BadFile: not readable as a domain, or domains that extend each other in a circle.
        BadValue: a rule that cannot be parsed, is impossible, or is wider than its parent's.
    """
    if isinstance(name, Path) or re.search(r"\.ya?ml$|[/\\]", name):
        return _load(Path(name), ())
    return _load(library.find("domains", name), ())


def domain_for_task(task: str) -> Domain:
    """The domain of the task's name if a library has one, else the global domain."""
    return load_domain(task if task in library.names("domains") else "global")


def _load(path: Path, children: tuple[Path, ...]) -> Domain:
    if path.resolve() in children:
        raise BadFile(path, "extends itself, directly or in a circle")
    content = library.read_yaml(path)
    for field in content:
        if field not in FIELDS:
            raise UnknownName("field", field, FIELDS, path)
    parent = _parent(content.get("extends"), path, children)
    rules = dict(parent.rules) if parent else {}
    sources = dict(parent.sources) if parent else {}
    raw = content.get("physics")
    if raw is not None and not isinstance(raw, dict):
        raise BadFile(path, "physics must be a mapping of attributes to rules")
    for key, text in _rules_by_prop(cast(dict[object, object], raw or {}), path).items():
        if key not in AUXILIARY:
            check_key(key, path)
        if text is None:  # nominal
            rules.pop(key, None)
            sources.pop(key, None)
            continue
        rule = parse_rule(key, text, str(path))
        _check_possible(key, rule, path)
        if parent:
            _check_narrower(key, rule, parent, path)
        rules[key], sources[key] = rule, path.stem
    _check_references(rules, path)
    return Domain(path.stem, dict(sorted(rules.items())), sources, str(content.get("why", "")))


def _rules_by_prop(raw: Mapping[object, object], path: Path) -> dict[str, object]:
    """Rules by key; one for several props (`friction@left,right`) becomes a rule of each.

    Raises `BadFile`: there are two rules for one prop.
    """
    found, said = dict[str, object](), dict[str, str]()
    for name, rule in raw.items():
        key, props = str(name), split(str(name))[1].split(",")
        dealt = cast(Mapping[object, object], rule).get("deal") if isinstance(rule, dict) else None
        for place, prop in enumerate(props):
            own = f"{split(key)[0]}{MARK}{prop.strip()}" if len(props) > 1 else key
            if own in said:
                raise BadFile(path, f"has two rules for {own}: {said[own]} and {key}; keep one")
            deal = {"deal": {"source": key, "place": place, "rules": dealt}}
            found[own] = rule if dealt is None or len(props) == 1 else deal
            said[own] = key
    return found


def _parent(extends: object, path: Path, children: tuple[Path, ...]) -> Domain | None:
    if extends is None:
        return None
    if not isinstance(extends, str):
        raise BadFile(path, f"extends needs the name of one domain, not {extends!r}")
    try:
        beside = path.parent / f"{plain_name(extends)}.yaml"
    except ValueError as error:
        raise BadFile(path, f"extends = {short_repr(extends)}: {error}") from error
    # A file outside every library may extend its neighbour, but a library's domain comes first.
    known = library.names("domains")
    if extends not in known and not beside.is_file():
        raise UnknownName("domain", extends, known, path)
    return _load(known.get(extends, beside), (*children, path.resolve()))


def _check_possible(key: str, rule: Distribution, path: Path) -> None:
    """Raise if the rule allows a value that the simulator cannot have."""
    if isinstance(rule, SameAs):
        return
    if key in AUXILIARY:
        if not rule.within(AUXILIARY[key]):
            raise BadValue(key, rule.to_json(), f"it is {AUXILIARY[key]}", path)
        return
    _check_extremes(key, rule, path)
    if not extremes(rule):
        raise BadValue(key, rule.to_json(), "an attribute needs numbers", path)


def _check_extremes(key: str, rule: Distribution, path: Path) -> None:
    varied = attribute(key)
    for value in extremes(rule):
        if varied.size > 1 and isinstance(value, float):  # one number for all components
            value = (value,) * varied.size
        varied.check(value, str(path), split(key)[1])


def _check_narrower(key: str, rule: Distribution, parent: Domain, path: Path) -> None:
    """Raise unless the rule narrows its parent's; a key that the parent lacks never does.

    A rule of one prop is a part of its task, so it narrows none but that of the same prop.
    """
    wide = parent.rule(key)
    if wide is None and split(key)[1]:
        return
    if isinstance(rule, SameAs):
        rule = parent.rule(rule.source) or rule
    if wide is None:
        nominal = attribute(key).nominal
        fixed = "the asset's own" if nominal is None else f"{nominal}"
        raise BadValue(key, rule.to_json(), f"domain {parent.name} holds it at {fixed}", path)
    if not narrows(rule, wide):
        allowed = f"domain {parent.name} allows {wide}, and a child may only narrow"
        raise BadValue(key, rule.to_json(), allowed, path)


def _check_references(rules: dict[str, Distribution], path: Path) -> None:
    """Raise unless `same_as` names a plain rule, and `by` has a rule for each option drawn."""
    for key, rule in rules.items():
        if isinstance(rule, SameAs):
            plain = {k for k, r in rules.items() if not isinstance(r, SameAs | By) and k != key}
            if rule.source not in plain - AUXILIARY.keys():
                kind = f"source of {key}"
                raise UnknownName(kind, rule.source, plain - AUXILIARY.keys(), path)
            _check_extremes(key, rules[rule.source], path)
        elif isinstance(rule, By):
            options = AUXILIARY.get(rule.selector)
            if not isinstance(options, Choice):
                selectors = [k for k, r in AUXILIARY.items() if isinstance(r, Choice)]
                raise UnknownName("selector", rule.selector, selectors, path)
            for name in rule.branches:
                if name not in options:
                    raise UnknownName(rule.selector, name, map(str, options.options), path)
            drawn = extremes(rules.get(rule.selector, options))
            if missing := [str(o) for o in drawn if o not in rule.branches]:
                need = f"it needs a rule for {rule.selector} {', '.join(missing)}"
                raise BadValue(key, rule.to_json(), need, path)


def parse_overrides(texts: Iterable[str]) -> dict[str, Value]:
    """Values by key from texts like "friction@puck=0.2", "center_of_mass=0,0,0.01".

    Raises:
        UnknownName: no such key; names the nearest match.
        BadValue: not `key=value`, a key twice, not a number, or outside what the simulator can do.
    """
    values: dict[str, Value] = {}
    for text in texts:
        key, equals, value = (part.strip() for part in text.partition("="))
        if not equals:
            raise BadValue("set", text, "write key=value, such as friction=0.2")
        if key not in AUXILIARY:
            check_key(key)
        if key in values:
            raise BadValue("set", text, f"{key} is held at {values[key]} already")
        if key == "camera_mode":
            values[key] = value
            continue
        try:
            numbers = tuple(float(part) for part in value.split(","))
        except ValueError:
            allowed = "it needs a number, or numbers with commas between"
            raise BadValue(key, value, allowed) from None
        values[key] = numbers[0] if len(numbers) == 1 else numbers
    check_overrides(values)
    return values
