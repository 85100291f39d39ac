"""Sweeps: the same collection with one attribute held at each of several values, on the same seeds.

It is written `friction=0.05,0.1`, with ';' between vectors: `center_of_mass=0,0,0.01;0,0,0.02`.
"""

from collections.abc import Mapping, Sequence
from dataclasses import replace

from rtphys.core.errors import BadValue
from rtphys.physics.load import parse_overrides
from rtphys.physics.values import Value
from rtphys.spec.collection import CollectionSpec
from rtphys.spec.protocol import load_protocol


def values_of(text: str) -> tuple[str, Mapping[str, Value]]:
    """Attribute of a sweep, and its values, each by how it is written.

    Raises `UnknownName`, `BadValue`: as `parse_overrides`; a value that is named twice.
    """
    key, equals, spelt = text.partition("=")
    key, parts = key.strip(), [part.strip() for part in spelt.split(_mark(spelt))]
    if not equals or not all(parts):
        raise BadValue("sweep", text, "write key=value,value, such as friction=0.1,0.2")
    if len(set(parts)) < len(parts):
        raise BadValue("sweep", text, "name each value once")
    return key, {part: parse_overrides([f"{key}={part}"])[key] for part in parts}


def _mark(text: str) -> str:
    """What stands between the values of a sweep."""
    return ";" if ";" in text else ","


def swept(spec: CollectionSpec, text: str) -> tuple[CollectionSpec, ...]:
    """The same again with one attribute held at each value, in folders of their own; same seeds.

    Raises `UnknownName`, `BadValue`: as `values_of`; an attribute that is held already; a twin that
    holds none.
    """
    key, values = values_of(text)
    episode, sweep = spec.episode, f"{key}={_mark(text).join(values)}"
    if key in episode.overrides:
        raise BadValue("sweep", key, "it is held at a value already")
    if spec.twin and not load_protocol(spec.twin).physics:
        raise BadValue("twin", spec.twin, "beside a sweep it must vary physics; this holds nothing")
    only = None if episode.only is None else tuple(dict.fromkeys((*episode.only, key)))
    found: list[CollectionSpec] = []
    for part, value in values.items():
        config = spec.config and f"{spec.config}.{key}={part}"
        held = replace(episode, only=only, overrides={**episode.overrides, key: value})
        found.append(replace(spec, episode=held, config=config, sweep=sweep))
    return tuple(found)


def families(specs: Sequence[CollectionSpec]) -> list[list[CollectionSpec]]:
    """The specs in groups that try the same seeds: the values of a sweep, in the sweep's order, or
    one alone."""
    found: list[list[CollectionSpec]] = []
    for spec in specs:
        alike = [one for one in found if spec.sweep and _alike(one[0], spec)]
        if alike:
            alike[0].append(spec)
        else:
            found.append([spec])
    return [sorted(family, key=_place) if family[0].sweep else family for family in found]


def _alike(one: CollectionSpec, other: CollectionSpec) -> bool:
    # The task first: to make what is unswept takes a hundred times as long.
    same = one.sweep == other.sweep and one.episode.task == other.episode.task
    return same and one.unswept == other.unswept


def _place(spec: CollectionSpec) -> int:
    (_, value), (_, values) = spec.swept, values_of(spec.sweep or "")
    return list(values.values()).index(value)


def paired(specs: Sequence[CollectionSpec]) -> list[list[CollectionSpec]]:
    """The specs in groups that have the same seeds, each twin among them."""
    found = families([spec for spec in specs if spec.twin_of is None])
    for twin in specs:
        if twin.twin_of is None:
            continue
        place = twin.episode.task, twin.episode.embodiment, twin.twin_of
        for group in found:
            mains = [(one.episode.task, one.episode.embodiment, one.name) for one in group]
            if place in mains:
                group.insert(mains.index(place) + 1, twin)
    return [group for group in found if group[0].paired]
