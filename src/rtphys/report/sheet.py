"""Contact sheet: frames of all cameras of an episode in one picture."""

import numpy as np
from numpy.typing import NDArray

from rtphys.data.dataset import Episode

COLUMNS = 8
GAP = 4  # [px]
WHITE = 255


def contact_sheet(episode: Episode, columns: int = COLUMNS) -> NDArray[np.uint8]:
    """Picture (H, W, 3) RGB with one row per camera: `columns` frames, evenly spaced in time."""
    picked = np.linspace(0, len(episode) - 1, min(columns, len(episode))).round().astype(int)
    rows = [_row([episode.image(camera, int(t)) for t in picked]) for camera in episode.cameras]
    width = max(row.shape[1] for row in rows)
    padded = [
        np.pad(r, ((0, GAP), (0, width - r.shape[1]), (0, 0)), constant_values=WHITE) for r in rows
    ]
    return np.concatenate(padded)


def _row(pictures: list[NDArray[np.uint8]]) -> NDArray[np.uint8]:
    spaced = [np.pad(p, ((0, 0), (0, GAP), (0, 0)), constant_values=WHITE) for p in pictures]
    return np.concatenate(spaced, axis=1)
