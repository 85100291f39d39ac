"""The physics of an episode: attributes, distributions and domains, without a simulator."""

from rtphys.physics.attribute import Attribute
from rtphys.physics.domain import Domain
from rtphys.physics.enforce import acting, disagreements, enforce, read_back
from rtphys.physics.handles import Blueprint, Body, Camera, Joint, Servo, Surface, World
from rtphys.physics.interval import Interval
from rtphys.physics.load import domain_for_task, load_domain
from rtphys.physics.overrides import parse_overrides
from rtphys.physics.readback import readback
from rtphys.physics.registry import attribute, attributes
from rtphys.physics.sampling import after
from rtphys.physics.values import Physics, Value, Vector

__all__ = [
    "Attribute",
    "Blueprint",
    "Body",
    "Camera",
    "Domain",
    "Interval",
    "Joint",
    "Physics",
    "Servo",
    "Surface",
    "Value",
    "Vector",
    "World",
    "acting",
    "after",
    "attribute",
    "attributes",
    "disagreements",
    "domain_for_task",
    "enforce",
    "load_domain",
    "parse_overrides",
    "read_back",
    "readback",
]
