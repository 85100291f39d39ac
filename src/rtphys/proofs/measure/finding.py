"""What an experiment finds: a measured value beside the label's, or why there is none."""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

Number = float | tuple[float, ...]  # in the attribute's own unit


@dataclass(frozen=True)
class Tolerance:
    """Largest deviation that an audit takes for exact: a share of the label, or an absolute one."""

    relative: float  # [1]
    absolute: float  # in the attribute's own unit

    def of(self, label: Number) -> float:
        """Allowed deviation from this label."""
        return max(self.absolute, self.relative * float(np.max(np.abs(label))))


TOLERANCES: Mapping[str, Tolerance] = {
    "arm_joint_damping": Tolerance(0.02, 0.0),
    "camera_angle": Tolerance(0.0, 0.01),  # [deg]
    "camera_distance": Tolerance(0.0, 1e-5),  # [m]
    "center_of_mass": Tolerance(0.0, 2e-5),  # [m]
    "external_force": Tolerance(0.01, 1e-4),
    "friction": Tolerance(0.005, 5e-4),
    "gripper_joint_damping": Tolerance(0.02, 0.0),
    "object_joint_damping": Tolerance(0.01, 1e-3),  # [N m s/rad or N s/m]
    "object_mass": Tolerance(0.01, 0.0),
    "object_scale": Tolerance(0.001, 0.0),
    "restitution": Tolerance(0.0, 0.01),
    "table_height": Tolerance(0.0, 1e-4),  # [m]
    "table_tilt": Tolerance(0.0, 0.02),  # [deg]
}
"""Attribute -> how exactly its experiment can tell it."""


@dataclass(frozen=True)
class Measurement:
    """One value of one body, surface or joint."""

    key: str  # the attribute
    place: str  # "can", "table", "laptop/lid"
    label: Number
    measured: Number

    @property
    def deviation(self) -> float:
        """Largest difference of a component; infinite where nothing sensible came out."""
        gap = np.max(np.abs(np.subtract(self.measured, self.label)))
        return float(gap) if np.isfinite(gap) else float("inf")

    @property
    def tolerance(self) -> float:
        """The deviation that is allowed."""
        return TOLERANCES[self.key].of(self.label)

    @property
    def passed(self) -> bool:
        return self.deviation <= self.tolerance


@dataclass(frozen=True)
class Unmeasured:
    """Something that a label states and no experiment can tell."""

    key: str
    place: str  # empty: nowhere in this episode
    why: str


Finding = Measurement | Unmeasured
