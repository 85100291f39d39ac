"""Pictures of recorded states: a world built again with visuals, lights and cameras."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from rtphys.core.poses import Pose
from rtphys.sim import renderer
from rtphys.sim.camera import CameraSpec, SimCamera, cam2world_gl, camera_specs, extrinsic_cv
from rtphys.sim.world import World
from rtphys.visual import LightColours


class Studio:
    """Cameras and lights around a world that was built with visuals.

    Args:
        world: `WorldPlan.visuals` was true; `renderer.configure` ran before it was built.
        cameras: short or official names.
    """

    def __init__(self, world: World, cameras: Sequence[str]) -> None:
        self.world = world
        world.room.draw_last()
        self._lamps = renderer.add_lights(world.scene)
        # Last, and never before: pack_poses goes by the order in which entities were added.
        specs = camera_specs(world.robot.embodiment, cameras)
        self.cameras = [SimCamera(world.scene, s, world.robot.articulation) for s in specs]
        for camera in self.cameras:
            if camera.spec.name == world.head_camera.name:
                camera.set_pose(world.head_camera.pose)
        self._full = world.scene.pack_poses()

    @property
    def specs(self) -> list[CameraSpec]:
        return [camera.spec for camera in self.cameras]

    def light(self, colours: LightColours) -> None:
        """Change the colours of the lights; None among them: the official colour."""
        plain = renderer.Lights(ambient=colours.ambient)
        self._lamps.recolour(
            replace(
                plain,
                directional=colours.directional or plain.directional,
                point_colours=colours.points or plain.point_colours,
            )
        )

    def show(self, packed: bytes) -> None:
        """Put every body where it was when `scene.pack_poses` was taken."""
        # A short buffer would leave lights and cameras at the origin, without an error.
        self.world.scene.unpack_poses(packed + self._full[len(packed) :])
        self.world.scene.update_render()

    def pictures(self) -> dict[str, NDArray[np.uint8]]:
        """Official camera name -> (H, W, 3) RGB of the state shown."""
        return {camera.spec.name: camera.capture() for camera in self.cameras}

    def poses(self) -> dict[str, Pose]:
        """Official camera name -> world pose in the state shown, SAPIEN axes."""
        return {camera.spec.name: camera.pose for camera in self.cameras}


def matrices(spec: CameraSpec, pose: Pose) -> tuple[NDArray[np.float32], ...]:
    """Intrinsic (3, 3), extrinsic (3, 4) and camera-to-world (4, 4) of one camera."""
    return spec.intrinsic_cv, extrinsic_cv(pose), cam2world_gl(pose)
