"""Rotation of the head camera about its own position."""

from collections.abc import Collection
from dataclasses import dataclass
from math import degrees, radians
from typing import cast

from rtphys.physics import gaze
from rtphys.physics.attribute import Attribute, Part, Reading
from rtphys.physics.handles import World
from rtphys.physics.values import Interval, Physics, Value, Vector


@dataclass(frozen=True)
class CameraAngle(Attribute[World, float]):
    """Angle of a rotation about an axis in the camera's frame, after `camera_distance`.

    The rotation with which an orbit keeps its gaze point belongs to `camera_distance`, not here.
    """

    key = "camera_angle"
    unit = "deg"
    nominal = 0.0
    valid = Interval(0, 90)
    resolution = 6e-5  # [deg] a few rounding errors of a single-precision quaternion
    auxiliary = ("camera_mode", "camera_direction")
    what = "turn of the head camera on the spot"

    mode: str = "rotate"
    direction: Vector = (0.0, 0.0, 1.0)  # unit vector in the camera frame

    def for_episode(self, physics: Physics) -> "CameraAngle":
        if physics["camera_mode"] is None:
            return self
        return CameraAngle(cast(str, physics["camera_mode"]), physics.vector("camera_direction"))

    def could_act(self, parts: Collection[Part], value: Value) -> bool:
        """Not where the mode of this episode is another one and leaves it at zero."""
        return value != 0 or self.mode == "rotate"

    def apply(self, target: World, value: float) -> None:
        gaze.turn_by(target.head_camera, self.mode, self.direction, radians(value))

    def read(self, world: World) -> dict[str, Reading]:
        camera = world.head_camera
        return {camera.name: degrees(gaze.angle_of(gaze.turn(camera, self.mode)))}
