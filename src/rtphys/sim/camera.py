"""Cameras: what there is to see with, where it looks, and the matrices that go with a picture.

A camera's own axes are SAPIEN's: x forward, y left, z up. Datasets speak OpenCV (x right, y down,
z forward) and OpenGL (x right, y up, z back).
"""

from collections.abc import Sequence
from dataclasses import dataclass, field
from math import radians, tan

import numpy as np
import sapien
from numpy.typing import NDArray

from rtphys.assets.embodiment import Embodiment
from rtphys.core.errors import MissingAsset, UnknownName
from rtphys.core.poses import Pose
from rtphys.sim import renderer
from rtphys.sim.engine import from_sapien, to_sapien
from rtphys.spec import recording
from rtphys.spec.recording import KINDS, RecordingSpec

Matrix = NDArray[np.float32]

NEAR, FAR = 0.1, 100.0  # [m] (RoboTwin)
WRIST_NEAR = 0.02  # [m] at 0.1 the camera would look through the fingers it is mounted over

# Where RoboTwin puts the two fixed cameras when an embodiment says nothing else [m].
HEAD = ((-0.032, -0.45, 1.35), (0.0, 0.6, -0.8))
FRONT = ((0.2, -0.45, 0.85), (0.0, 1.0, -0.1))

_CV_FROM_SAPIEN = np.array([[0, -1, 0], [0, 0, -1], [1, 0, 0]], float)
_CV_FROM_GL = np.diag([1.0, -1.0, -1.0, 1.0])


@dataclass(frozen=True)
class CameraSpec:
    """A camera of given optics, fixed in the world or mounted on a robot link."""

    name: str  # official: head_camera, left_camera, right_camera, front_camera
    width: int = 320  # [px]
    height: int = 240  # [px]
    fovy: float = radians(37.0)  # vertical field of view [rad]
    pose: Pose = field(default_factory=Pose)  # in the world, or in the link's frame
    link: str = ""  # the robot link that carries it; empty: fixed in the world

    @property
    def intrinsic_cv(self) -> Matrix:
        """(3, 3) [px]: square pixels, no skew, principal point in the middle."""
        f = self.height / 2 / tan(self.fovy / 2)
        K = [[f, 0, self.width / 2], [0, f, self.height / 2], [0, 0, 1]]
        return np.array(K, np.float32)


def extrinsic_cv(X_WC: Pose) -> Matrix:
    """(3, 4) world -> camera in OpenCV axes [m], of a camera at `X_WC`."""
    return _world_to_cv(X_WC)[:3].astype(np.float32)


def cam2world_gl(X_WC: Pose) -> Matrix:
    """(4, 4) camera in OpenGL axes -> world [m]."""
    return (np.linalg.inv(_world_to_cv(X_WC)) @ _CV_FROM_GL).astype(np.float32)


def _world_to_cv(X_WC: Pose) -> NDArray[np.float64]:
    X = np.eye(4)
    X[:3, :3] = _CV_FROM_SAPIEN @ X_WC.R.T
    X[:3, 3] = -X[:3, :3] @ X_WC.p
    return X


def looking(position: Sequence[float], forward: Sequence[float], left: object = None) -> Pose:
    """Pose of a camera at `position` [m] that looks along `forward`.

    `left` is its left direction; by default the horizontal one, so that the camera has no roll.
    """
    x = np.asarray(forward, float) / np.linalg.norm(forward)
    y = np.cross([0.0, 0.0, 1.0], x) if left is None else np.asarray(left, float)
    y = y - (y @ x) * x  # SAPIEN wants a rotation; configurations give rounded numbers
    y = y / np.linalg.norm(y)
    X = np.eye(4)
    X[:3, :3], X[:3, 3] = np.column_stack([x, y, np.cross(x, y)]), position
    return Pose.from_matrix(X)


def camera_specs(embodiment: Embodiment, recording_spec: RecordingSpec) -> list[CameraSpec]:
    """The cameras asked for, in that order.

    Raises:
        UnknownName: the embodiment states a camera type that does not exist.
    """
    specs = []
    for name in recording_spec.official:
        kind, link = "D435", ""
        pose = looking(*(HEAD if name == recording.HEAD else FRONT))
        for camera in embodiment.cameras:
            if camera.name == name:
                kind = camera.kind
                pose = looking(camera.position.tolist(), camera.forward.tolist(), camera.left)
        for limb in embodiment.limbs:
            if name == f"{limb.side}_camera":
                kind, link = "D435", limb.camera.link
                pose = limb.camera.offset or Pose()
        if kind not in KINDS:
            raise UnknownName("camera type", kind, KINDS, name)
        width, height, fovy_deg = recording_spec.optics(kind)
        specs.append(CameraSpec(name, width, height, radians(fovy_deg), pose, link))
    return specs


class SimCamera:
    """A camera in a scene. Add cameras after everything else: `scene.pack_poses` is by order.

    Args:
        scene: a scene with a render system, lit by `renderer.add_lights`.
        spec: what to add.
        robot: the articulation that carries a mounted camera.
        senses: whether it will be asked for more than colours (`sense`).

    Raises:
        MissingAsset: the robot has no such link.
    """

    def __init__(
        self,
        scene: sapien.Scene,
        spec: CameraSpec,
        robot: sapien.physx.PhysxArticulation | None = None,
        senses: bool = False,
    ) -> None:
        self.spec = spec
        shader = renderer.sensing_shader() if senses else ""  # empty: the process's own
        component = sapien.render.RenderCameraComponent(spec.width, spec.height, shader)
        component.set_fovy(spec.fovy, compute_x=True)
        component.near, component.far = WRIST_NEAR if spec.link else NEAR, FAR
        component.name = spec.name
        if spec.link:
            links = {link.name: link for link in robot.links} if robot else {}
            if spec.link not in links:
                raise MissingAsset(f"link {spec.link!r}", robot.name if robot else "", spec.name)
            links[spec.link].entity.add_component(component)
            component.local_pose = to_sapien(spec.pose)
        else:
            mount = sapien.Entity()
            mount.name = spec.name
            mount.add_component(component)
            mount.set_pose(to_sapien(spec.pose))
            scene.add_entity(mount)
        self.component = component

    @property
    def pose(self) -> Pose:
        """World pose now, SAPIEN axes."""
        return from_sapien(self.component.global_pose)

    def set_pose(self, pose: Pose) -> None:
        """Move a fixed camera (world), or a mounted one within its link's frame."""
        if self.spec.link:
            self.component.local_pose = to_sapien(pose)
        else:
            self.component.entity.set_pose(to_sapien(pose))
