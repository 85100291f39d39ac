"""Inputs of the network: the current command and the poses of the task's objects."""

from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

CHUNK = 8  # actions predicted at once and carried out before the next observation


def features(
    command: NDArray[np.float64], poses: Mapping[str, NDArray[np.float64]]
) -> NDArray[np.float32]:
    """Inputs (n, 14 + 9 per object) from commands (n, 14) and poses (n, 7) by object.

    Two columns of its matrix represent a rotation: they are continuous, unlike a quaternion.
    """
    parts = [command]
    for name in sorted(poses):
        pose = poses[name]
        w, x, y, z = pose[:, 3:].T
        first = [1 - 2 * (y * y + z * z), 2 * (x * y + w * z), 2 * (x * z - w * y)]
        second = [2 * (x * y - w * z), 1 - 2 * (x * x + z * z), 2 * (y * z + w * x)]
        parts += [pose[:, :3], np.stack([*first, *second], axis=1)]
    return np.concatenate(parts, axis=1).astype(np.float32)
