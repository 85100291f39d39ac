"""The pose of the head camera, which physics may change; pictures are taken from it later."""

import numpy as np

from rtphys.assets.embodiment import Embodiment
from rtphys.core.poses import Pose
from rtphys.sim.room import TOP


class HeadCamera:
    """The camera over the robot's head (`rtphys.physics.handles.Camera`), world frame."""

    name = "head_camera"

    def __init__(self, embodiment: Embodiment) -> None:
        spec = next(c for c in embodiment.cameras if c.name == self.name)
        forward = spec.forward / np.linalg.norm(spec.forward)
        left = spec.left / np.linalg.norm(spec.left)
        axes = np.column_stack([forward, left, np.cross(forward, left)])
        X_WC = np.eye(4)
        X_WC[:3, :3], X_WC[:3, 3] = axes, spec.position
        self._nominal = Pose.from_matrix(X_WC)
        self._pose = self._nominal

    @property
    def nominal_pose(self) -> Pose:
        return self._nominal

    @property
    def pose(self) -> Pose:
        return self._pose

    def set_pose(self, pose: Pose) -> None:
        self._pose = pose

    @property
    def range_to_table(self) -> float:
        """[m] along the optical axis from the nominal pose to the nominal table top."""
        down = -self._nominal.R[2, 0]
        return float((self._nominal.p[2] - TOP) / down)
