"""Pictures of recorded states: a world built again with visuals, lights and cameras."""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cache
from typing import Any

import numpy as np
import sapien
from numpy.typing import NDArray

from rtphys.core.poses import Pose
from rtphys.senses import SENSES, Pixels
from rtphys.sim import renderer
from rtphys.sim.camera import CameraSpec, SimCamera, cam2world_gl, camera_specs, extrinsic_cv
from rtphys.sim.world import World
from rtphys.spec.recording import HEAD, RecordingSpec
from rtphys.visual.look import LightColours

BACKGROUND = "background"
MOST = 139  # ids, 0 included, that the official palette has colours for
BETWEEN = " | "  # of the names of meshes that share an id


class Identities:
    """Numbers what a scene draws, in the order in which it was built; 0 is the background.

    Where there are more than the palette has colours, numbers are given out again from 1.

    Attributes:
        names: "actor" and "mesh" -> name of each id.
        actors, meshes: SAPIEN's id of an entity or shape -> number (beyond the last: 0).
    """

    def __init__(self, world: World) -> None:
        known = _names(world)
        actors, meshes = dict[int, str](), dict[int, str]()
        for entity in world.scene.entities:
            shapes = [
                shape
                for body in entity.components
                if isinstance(body, sapien.render.RenderBodyComponent)
                for shape in body.render_shapes
            ]
            if not shapes:
                continue
            name = known.get(entity.per_scene_id, entity.name)
            actors[entity.per_scene_id] = name
            for n, shape in enumerate(shapes):
                meshes[shape.per_scene_id] = name if len(shapes) == 1 else f"{name}/{n}"
        self.actors, actor_names = _numbered(actors)
        self.meshes, mesh_names = _numbered(meshes)
        self.names = {"actor": actor_names, "mesh": mesh_names}


def body_names(world: World, count: int) -> tuple[str, ...]:
    """Names of the first bodies of a scene, in the order of `scene.pack_poses`."""
    known = _names(world)
    entities: Iterable[sapien.Entity] = world.scene.entities[:count]
    return tuple(known.get(entity.per_scene_id, entity.name) for entity in entities)


def _names(world: World) -> dict[int, str]:
    """Entity's id -> name of the object, and of the link if it has several."""
    return {
        component.entity.per_scene_id: f"{name}/{link}" if len(thing.links) > 1 else name
        for name, thing in world.scene_objects.items()
        for link, component in thing.links.items()
    }


def _numbered(names: dict[int, str]) -> tuple[NDArray[np.uint8], tuple[str, ...]]:
    """Scene's id -> number, and the name of each number."""
    table = np.zeros(max(names, default=0) + 2, np.uint8)
    shared: dict[int, list[str]] = {0: [BACKGROUND]}
    for n, scene_id in enumerate(sorted(names)):
        table[scene_id] = number = 1 + n % (MOST - 1)
        shared.setdefault(number, []).append(names[scene_id])
    return table, tuple(BETWEEN.join(shared[number]) for number in sorted(shared))


@dataclass(frozen=True, eq=False)
class CameraFrame:
    """What one camera saw at one instant."""

    rgb: NDArray[np.uint8]  # (H, W, 3)
    # Field of each sense that was asked for (`rtphys.senses`) -> its array.
    senses: Mapping[str, NDArray[Any]] = field(default_factory=dict)


class SceneRenderer:
    """Cameras and lights around a world that was built with visuals.

    Args:
        world: `WorldPlan.visuals` was true; `renderer.configure` ran before it was built.
        recording_spec: the cameras, and what they are asked for.

    Raises:
        BadValue: senses are asked for, and the process's shader gives none.
    """

    def __init__(self, world: World, recording_spec: RecordingSpec) -> None:
        self.world, self._X_TW = world, world.X_WT.inverse().matrix
        self._senses = [SENSES[name] for name in recording_spec.senses if SENSES[name].drawn]
        sensing = bool(self._senses)
        self._identities = Identities(world) if sensing else None
        world.room.draw_last()
        self._lights = renderer.Lights(world.scene)
        # Last, and never before: pack_poses goes by the order in which entities were added.
        self.specs = camera_specs(world.robot.embodiment, recording_spec)
        robot = world.robot.articulation
        self.cameras = [SimCamera(world.scene, spec, robot, sensing) for spec in self.specs]
        for camera in self.cameras:
            if camera.spec.name == world.head_camera.name:
                camera.set_pose(world.head_camera.pose)
        self._full = world.scene.pack_poses()

    def light(self, colours: LightColours) -> None:
        """Change the colours of the lights."""
        self._lights.recolour(colours)

    def show(self, packed: bytes) -> None:
        """Put every body where it was when `scene.pack_poses` was taken."""
        # A short buffer would leave lights and cameras at the origin, without an error.
        self.world.scene.unpack_poses(packed + self._full[len(packed) :])
        self.world.scene.update_render()

    @property
    def components(self) -> list[sapien.render.RenderCameraComponent]:
        """SAPIEN's part of each camera."""
        return [camera.component for camera in self.cameras]

    @property
    def buffers(self) -> tuple[str, ...]:
        """SAPIEN's names of what is read from a camera."""
        sensing = self._identities is not None
        return renderer.COLOUR + renderer.SENSE_BUFFERS * sensing

    @property
    def names(self) -> dict[str, tuple[str, ...]]:
        """ "actor" and "mesh" -> name of each id; empty where no camera is asked for senses."""
        return {} if self._identities is None else self._identities.names

    def frames(self, reads: Sequence[renderer.Read] | None = None) -> dict[str, CameraFrame]:
        """Official camera name -> what it sees of the state shown.

        `reads`: of each camera where its pictures are, if something else has drawn them.
        """
        if reads is None:
            for component in self.components:
                component.take_picture()
            reads = [component.get_picture for component in self.components]
        found: dict[str, CameraFrame] = {}
        ids = self._identities
        for camera, read in zip(self.cameras, reads, strict=True):
            if ids is None:
                found[camera.spec.name] = CameraFrame(renderer.picture(read))
                continue
            pixels = self._pixels(camera, read, ids)
            senses: dict[str, NDArray[Any]] = {}
            for sense in self._senses:
                if sense.scope == "pixel" or camera.spec.name == HEAD:
                    senses |= sense.capture(pixels)
            found[camera.spec.name] = CameraFrame(pixels.rgb, senses)
        return found

    def _pixels(self, camera: SimCamera, read: renderer.Read, ids: Identities) -> Pixels:
        near, far = camera.component.near, camera.component.far

        @cache  # read once, if at all
        def buffers() -> renderer.Sensed:
            return renderer.sensed(read, near, far)

        return Pixels(
            renderer.picture(read),
            lambda: buffers().depth,
            lambda: np.take(ids.actors, buffers().entities, mode="clip"),
            lambda: np.take(ids.meshes, buffers().shapes, mode="clip"),
            camera.spec.intrinsic_cv,
            cam2world_gl(camera.pose),
            self._X_TW,
        )

    def poses(self) -> dict[str, Pose]:
        """Official camera name -> world pose in the state shown, SAPIEN axes."""
        return {camera.spec.name: camera.pose for camera in self.cameras}


def matrices(spec: CameraSpec, pose: Pose) -> tuple[NDArray[np.float32], ...]:
    """Intrinsic (3, 3), extrinsic (3, 4) and camera-to-world (4, 4) of one camera."""
    return spec.intrinsic_cv, extrinsic_cv(pose), cam2world_gl(pose)
