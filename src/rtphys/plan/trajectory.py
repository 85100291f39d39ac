"""The input and output of motion planning: joint limits and sampled motions."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from rtphys.core.errors import BadValue
from rtphys.core.poses import Array


def _frozen(value: ArrayLike) -> Array:
    array = np.array(value, float)
    array.setflags(write=False)
    return array


@dataclass(frozen=True, eq=False)
class JointLimits:
    """Symmetric limits of d joints.

    Raises:
        BadValue: a limit that is not a positive number.
    """

    velocity: Array  # (d,) [rad/s]
    acceleration: Array  # (d,) [rad/s^2]

    def __post_init__(self) -> None:
        for key in ("velocity", "acceleration"):
            values = np.atleast_1d(_frozen(getattr(self, key)))
            if not (np.isfinite(values) & (values > 0)).all():
                raise BadValue(f"joint {key} limit", values.tolist(), "limits are > 0")
            object.__setattr__(self, key, values)

    def scaled(self, speed: float) -> "JointLimits":
        """Limits of the same paths at `speed` times the pace: v scales by it, a by its square."""
        return JointLimits(self.velocity * speed, self.acceleration * speed**2)


@dataclass(frozen=True, eq=False)
class Trajectory:
    """A motion sampled at a fixed step. Row 0 is the start, the last row the goal, at rest."""

    q: Array  # (N, d) [rad]
    qd: Array  # (N, d) [rad/s]

    def __post_init__(self) -> None:
        object.__setattr__(self, "q", _frozen(self.q))
        object.__setattr__(self, "qd", _frozen(self.qd))

    def __len__(self) -> int:
        return len(self.q)
