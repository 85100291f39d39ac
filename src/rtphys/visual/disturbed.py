"""Finds clutter that an episode disturbed: pushed away or tipped over."""

from collections.abc import Mapping

import numpy as np

from rtphys.core.poses import Array, quat_to_matrix

MOVED = 0.02  # [m] distance from its position when the policy stage began
TIPPED = np.radians(15.0)  # [rad] angle of its up axis from its direction then


def disturbed(tracks: Mapping[str, Array]) -> tuple[str, ...]:
    """Names of the pieces that were disturbed at any time of the episode.

    Args:
        tracks: name of a piece -> its world poses (T, 7), xyz [m] + wxyz, from the start on.
    """
    return tuple(name for name, poses in tracks.items() if _moved(poses) or _tipped(poses))


def _moved(poses: Array) -> bool:
    return bool(np.linalg.norm(poses[:, :3] - poses[0, :3], axis=1).max() > MOVED)


def _tipped(poses: Array) -> bool:
    up = np.array([quat_to_matrix(q)[:, 1] for q in poses[:, 3:]])  # a piece's own y is up
    return bool((up @ up[0]).min() < np.cos(TIPPED))
