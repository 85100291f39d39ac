"""The physics of an episode: attributes, distributions and domains, without a simulator."""

from rtphys.physics.attribute import Attribute, attributes
from rtphys.physics.domain import Domain, after
from rtphys.physics.enforce import could_act, disagreements, enforce, readback
from rtphys.physics.handles import Blueprint, World
from rtphys.physics.load import domain_for_task, load_domain, parse_overrides
from rtphys.physics.values import Interval, Physics, Value, Vector

__all__ = [
    "Attribute",
    "Blueprint",
    "Domain",
    "Interval",
    "Physics",
    "Value",
    "Vector",
    "World",
    "after",
    "attributes",
    "could_act",
    "disagreements",
    "domain_for_task",
    "enforce",
    "load_domain",
    "parse_overrides",
    "readback",
]
