"""How far the head camera is turned on the spot."""

from dataclasses import dataclass
from math import degrees, radians
from typing import cast

from rtphys.physics import gaze
from rtphys.physics.attribute import Attribute, Reading
from rtphys.physics.handles import World
from rtphys.physics.interval import Interval
from rtphys.physics.values import Physics, Vector


@dataclass(frozen=True)
class CameraAngle(Attribute[World, float]):
    """Rotation about an axis in the camera's frame, on top of what `camera_distance` did.

    The re-gazing of an orbit belongs to `camera_distance`; this angle is then 0.
    """

    key = "camera_angle"
    unit = "deg"
    nominal = 0.0
    valid = Interval(0, 90)
    resolution = 6e-5  # [deg] a few roundings of a single-precision quaternion
    auxiliary = ("camera_mode", "camera_direction")
    what = "turn of the head camera on the spot"

    mode: str = "rotate"
    direction: Vector = (0.0, 0.0, 1.0)  # unit vector in the camera frame

    def for_episode(self, physics: Physics) -> "CameraAngle":
        if physics["camera_mode"] is None:
            return self
        return CameraAngle(cast(str, physics["camera_mode"]), physics.vector("camera_direction"))

    def apply(self, target: World, value: float) -> None:
        gaze.turn_by(target.head_camera, self.mode, self.direction, radians(value))

    def read(self, world: World) -> dict[str, Reading]:
        camera = world.head_camera
        return {camera.name: degrees(gaze.angle_of(gaze.turn(camera, self.mode)))}
