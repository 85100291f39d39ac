"""Distance of the head camera from its nominal position."""

from collections.abc import Collection
from dataclasses import dataclass
from typing import cast

import numpy as np

from rtphys.physics import gaze
from rtphys.physics.attribute import Attribute, Part, Reading
from rtphys.physics.handles import World
from rtphys.physics.values import Interval, Physics, Value, Vector


@dataclass(frozen=True)
class CameraDistance(Attribute[World, float]):
    """Straight-line distance between nominal and actual position.

    Mode orbit keeps the range and the gaze point; mode shift keeps the orientation.
    """

    key = "camera_distance"
    unit = "m"
    nominal = 0.0
    valid = Interval(0, 0.5)
    resolution = 3e-7  # [m] single precision at 1.35 m
    auxiliary = ("camera_mode", "camera_direction")
    what = "displacement of the head camera"

    mode: str = "orbit"
    direction: Vector = (0.0, 1.0, 0.0)  # unit vector in the camera frame

    def for_episode(self, physics: Physics) -> "CameraDistance":
        if physics["camera_mode"] is None:
            return self
        return CameraDistance(cast(str, physics["camera_mode"]), physics.vector("camera_direction"))

    def could_act(self, parts: Collection[Part], value: Value) -> bool:
        """Not where the camera only turns in this episode."""
        return value != 0 or self.mode != "rotate"

    def apply(self, target: World, value: float) -> None:
        gaze.move(target.head_camera, self.mode, self.direction, value)

    def read(self, world: World) -> dict[str, Reading]:
        camera = world.head_camera
        return {camera.name: float(np.linalg.norm(camera.pose.p - camera.nominal_pose.p))}
