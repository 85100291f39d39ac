"""Draws that are no attributes themselves but that attributes need."""

from collections.abc import Mapping
from types import MappingProxyType

from rtphys.physics.distribution import Choice, Direction, Distribution
from rtphys.physics.gaze import MODES

# A domain may narrow these; without a rule of its own it has them as they stand here.
AUXILIARY: Mapping[str, Distribution] = MappingProxyType(
    {
        "camera_mode": Choice(MODES),  # how the head camera moves in this episode
        "camera_direction": Direction(),  # where to, or about which axis; camera frame
    }
)
