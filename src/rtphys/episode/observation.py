"""What a policy sees of the world at one instant; a second world draws it."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any, TypeVar

import numpy as np
from numpy.typing import NDArray

from rtphys.assets.embodiment import Embodiment
from rtphys.assets.pack import Pack
from rtphys.core.errors import UnknownName
from rtphys.core.poses import Array
from rtphys.episode.generate import Instance, prepare
from rtphys.senses import drawn
from rtphys.senses.touch import Touch
from rtphys.sim import renderer
from rtphys.sim.robot import SimRobot
from rtphys.sim.scene_renderer import SceneRenderer, matrices
from rtphys.spec.recording import CAMERAS, RecordingSpec

V = TypeVar("V")


@dataclass(frozen=True, eq=False)
class CameraView:
    """One camera at the instant of the observation."""

    rgb: NDArray[np.uint8]  # (H, W, 3) RGB, usually (240, 320, 3)
    intrinsic_cv: NDArray[np.float32]  # (3, 3) [px]
    extrinsic_cv: NDArray[np.float32]  # (3, 4) world -> camera, OpenCV axes [m]
    cam2world_gl: NDArray[np.float32]  # (4, 4) camera -> world, OpenGL axes [m]
    # Field of each sense that the episode was begun with (`rtphys.senses`) -> its array.
    senses: Mapping[str, NDArray[Any]] = field(default_factory=dict)

    @property
    def depth(self) -> NDArray[np.float32] | None:
        """(H, W) [m] along the optical axis, 0 where nothing is; None without this sense."""
        return self.senses.get("depth")

    @property
    def actors(self) -> NDArray[np.uint8] | None:
        """(H, W) id of the body, see `View.names`; None without this sense. `meshes` likewise."""
        return self.senses.get("actors")

    @property
    def meshes(self) -> NDArray[np.uint8] | None:
        return self.senses.get("meshes")


@dataclass(frozen=True, eq=False)
class View:
    """All cameras at one instant."""

    cameras: Mapping[str, CameraView]  # by short name
    names: Mapping[str, tuple[str, ...]] = field(default_factory=dict)  # "actor", "mesh": of ids

    @property
    def cloud(self) -> NDArray[np.float32] | None:
        """(1024, 6) x y z [m] in the world, r g b 0..1, of the head camera; None without it."""
        return self.cameras["head"].senses.get("cloud") if "head" in self.cameras else None


class ByCamera(dict[str, V]):
    """By short name, `head`; the official one, `head_camera`, finds the same."""

    def __missing__(self, name: str) -> V:
        short = name.removesuffix("_camera")
        if short in self:
            return self[short]
        raise UnknownName("camera", name, self)


class Observation:
    """One instant. Pictures show this instant; they are drawn when they are first asked for.

    Openings are 0 closed .. 1 open. Poses are xyz [m] + wxyz, world frame. What the robot measures
    is read when this is made, and worked out when it is asked for: a blind policy asks for none.

    Args:
        time: [s] since the policy stage began.
        draw: draws this instant.
        feel: what the fingers felt; None: without that sense.
    """

    def __init__(
        self,
        time: float,
        robot: SimRobot,
        draw: Callable[[], View],
        feel: Callable[[], Touch] | None = None,
    ) -> None:
        self.time = time
        self._robot, self._draw, self._feel, art = robot, draw, feel, robot.articulation
        self._qpos, self._qvel = art.qpos, art.qvel
        self._forces = art.link_incoming_joint_forces
        self._links = [arm.ee_link.entity_pose for arm in robot.arms]
        self.vector: Array = np.array([x for arm in robot.arms for x in arm.commanded])
        """(N,) drive targets [rad] and openings, in the embodiment's `action_layout`."""

    @property
    def embodiment(self) -> Embodiment:
        """The robot's description."""
        return self._robot.embodiment

    @cached_property
    def endposes(self) -> Mapping[str, Array]:
        """Measured poses (7,) of the ee frames, "left" and "right"."""
        arms = zip(self._robot.arms, self._links, strict=True)
        return {arm.side: arm.ee_on(link).flat for arm, link in arms}

    @cached_property
    def measured(self) -> Array:
        """(N,) joint positions [rad] and openings measured, in the order of `vector`."""
        qpos, arms = self._qpos.astype(float), self._robot.arms
        return np.concatenate([np.append(qpos[a.index], a.opening_at(self._qpos)) for a in arms])

    @cached_property
    def velocities(self) -> Array:
        """(N - 2,) joint velocities measured, left then right [rad/s]."""
        qvel = self._qvel.astype(float)
        return np.concatenate([qvel[arm.index] for arm in self._robot.arms])

    @cached_property
    def efforts(self) -> Array:
        """(N,) what each joint exerts, measured [N m], and the mean of a hand's fingers [N].

        In the order of `vector`. That of fingers is negative when they press on something.
        """
        effort, arms = self._robot.effort_of(self._forces), self._robot.arms
        return np.concatenate(
            [np.append(effort[a.index], effort[a.finger_index].mean()) for a in arms]
        )

    @property
    def grippers(self) -> tuple[float, float]:
        """Commanded openings, left and right."""
        left, right = self.embodiment.action_layout.grippers
        return float(self.vector[left]), float(self.vector[right])

    @cached_property
    def view(self) -> View:
        """All that is drawn of this instant, senses included. Raises as `cameras`."""
        return self._draw()

    @cached_property
    def touch(self) -> Touch | None:
        """What the fingers felt since the last frame, at most 60 ms ago; T = 1."""
        return None if self._feel is None else self._feel()

    @property
    def felt(self) -> Mapping[str, NDArray[Any]]:
        """The arrays of `touch` at this instant, by field; empty without that sense."""
        return {} if self.touch is None else {k: a[0] for k, a in self.touch.arrays().items()}

    @property
    def cameras(self) -> Mapping[str, CameraView]:
        """Pictures and matrices by short name: head, left, right (and front if asked for).

        Raises `NoRenderer`: this machine cannot draw; `BadValue`: senses are asked for, and the
        process's shader gives none.
        """
        return ByCamera(self.view.cameras)

    @property
    def cloud(self) -> NDArray[np.float32] | None:
        """Point cloud of the head camera (`View.cloud`). Raises as `cameras`."""
        return self.view.cloud

    @property
    def images(self) -> Mapping[str, NDArray[np.uint8]]:
        """Pictures alone, (240, 320, 3) RGB by short name. Raises `NoRenderer`."""
        return ByCamera({name: view.rgb for name, view in self.cameras.items()})


class Mirror:
    """Draws the simulated world. Built on the first picture, because a blind policy needs none."""

    def __init__(self, instance: Instance, pack: Pack, recording_spec: RecordingSpec) -> None:
        self._instance, self._pack, self._recording_spec = instance, pack, recording_spec
        self._scene: SceneRenderer | None = None

    def view(self, packed: bytes, frame: int) -> View:
        """What all cameras see of the state that `scene.pack_poses` gave.

        `frame`: number of frames since the policy stage began; lights may flicker by it.

        Raises `NoRenderer`: no device to draw with.
        """
        instance = self._instance
        if self._scene is None:
            renderer.hold_anchor(drawn(self._recording_spec.senses))
            shown = prepare(instance.recipe, instance.task, self._pack, visuals=True)
            self._scene = SceneRenderer(shown.world, self._recording_spec)
        scene = self._scene
        scene.light(instance.look.backdrop.lights_at(frame))
        scene.show(packed)
        seen, poses, cameras = scene.frames(), scene.poses(), dict[str, CameraView]()
        short_names = {official: short for short, official in CAMERAS.items()}
        for spec in scene.specs:
            what, (K, extrinsic, gl) = seen[spec.name], matrices(spec, poses[spec.name])
            view = CameraView(what.rgb, K, extrinsic, gl, what.senses)
            cameras[short_names[spec.name]] = view
        return View(cameras, scene.names)
