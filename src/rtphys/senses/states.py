"""States: the poses of all bodies, to the last bit: all that a picture needs."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from rtphys.senses.sense import Array, Arrays, Field, Names, Sense

POSE = "x y z [m], qw qx qy qz; world frame"  # unit of a pose, in a file
NORMAL = 1e-3  # how far a quaternion's length may be from 1


@dataclass(frozen=True, eq=False)
class BodyPoses:
    """The pose of every body at every frame."""

    names: tuple[str, ...]  # of n bodies
    poses: NDArray[np.float32]  # (T, n, 7) xyz [m] + wxyz, world frame

    @property
    def kinds(self) -> Names:
        """Its names by kind, as a file has them."""
        return {"body": self.names}

    @staticmethod
    def of(tracks: Mapping[tuple[str, str], Any], names: Names) -> "BodyPoses":
        """From what a file holds."""
        return BodyPoses(names["body"], tracks["bodies", ""])


class States(Sense):
    """`BodyPoses`, from which `render` draws again."""

    name = "states"
    scope = "bodies"
    size = 80 * 7 * 4  # a scene has 24 bodies or more, with clutter up to about 80
    fields = (
        Field(
            "bodies",
            ("rtphys/body_poses", "rtphys/body_poses"),
            np.float32,
            ("body", 7),
            packed=False,
            notes=(("unit", POSE),),
        ),
    )

    def capture(self, source: BodyPoses) -> Arrays:
        return {"bodies": source.poses}

    def space(self) -> None:
        """Poses of bodies are in every observation of the state."""

    def problem(self, frames: Array) -> str:
        lengths = np.linalg.norm(frames[..., 3:], axis=-1)
        if np.allclose(lengths, 1, atol=NORMAL):
            return ""
        return "holds quaternions that are not of unit length"
