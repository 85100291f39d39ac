"""One factor at a time: the same seeds again, one attribute held at each of its values."""

from collections.abc import Iterable
from dataclasses import replace

from rtphys.core.errors import BadValue
from rtphys.physics.overrides import parse_overrides
from rtphys.physics.values import Value
from rtphys.studies.collect.plan import CollectPlan


def swept(plan: CollectPlan, text: str) -> tuple[CollectPlan, ...]:
    """One plan a value, each with a leaf of its own, `<protocol>.<attribute>=<value>`.

    Args:
        text: "friction=0.05,0.1", or ';' between vectors: "center_of_mass=0,0,0.01;0,0,0.02".

    Raises:
        UnknownName, BadValue: as `--set`; a value that is named twice; one that is also held.
    """
    key, equals, spelt = text.partition("=")
    key = key.strip()
    parts = [part.strip() for part in spelt.split(";" if ";" in spelt else ",")]
    if not equals or not all(parts):
        raise BadValue("--sweep", text, "write key=value,value, such as friction=0.1,0.2")
    if len(set(parts)) < len(parts):
        raise BadValue("--sweep", text, "name each value once")
    if key in plan.overrides:
        raise BadValue("--sweep", key, "it is held by --set already")
    values: Iterable[dict[str, Value]] = [parse_overrides([f"{key}={part}"]) for part in parts]
    return tuple(
        replace(
            plan,
            overrides={**plan.overrides, **value},
            only=None if plan.only is None else tuple(dict.fromkeys((*plan.only, key))),
            config=f"{plan.config or plan.protocol}.{key}={part}",
        )
        for part, value in zip(parts, values, strict=True)
    )
