"""Auxiliary draws: keys that are no attributes themselves but that attributes need."""

from collections.abc import Mapping
from types import MappingProxyType

from rtphys.physics.distribution import Choice, Direction, Distribution
from rtphys.physics.gaze import MODES

# Rules of a domain that has none of its own for the key; a domain may narrow them.
AUXILIARY: Mapping[str, Distribution] = MappingProxyType(
    {
        "camera_mode": Choice(MODES),  # how the head camera is displaced in this episode
        "camera_direction": Direction(),  # unit vector, or axis of rotation; camera frame
    }
)
