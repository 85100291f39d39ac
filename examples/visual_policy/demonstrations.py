"""A dataset's episodes as arrays to train on, without PyTorch."""

import hashlib
from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from sight import PICTURES, felt_frames, shrink

from rtphys.data.dataset import Episode

CHUNK = 16  # commands predicted at once
AFTER = 3  # frames kept after the first success; later ones go back through the same postures
PAUSE = 2  # frames kept of a pause: who sees a single frame learns to stay where many stand still
STILL = 1e-3  # [rad, or of an opening] by which a command moves in a pause, at most

Floats = NDArray[np.float32]
Arrays = tuple[NDArray, ...]


@dataclass(frozen=True, eq=False)
class Demonstrations:
    """N frames of several episodes."""

    seen: dict[str, Arrays]  # by camera, arrays of N rows: features of its pictures
    command: Floats  # (N, 14) in force: left arm [rad], left opening, right arm, right opening
    following: Floats  # (N, CHUNK, 14) the next commands; behind the end, the last one
    objects: Floats  # (N, 3 k) positions of the task's k objects [m], world frame
    felt: Floats  # (N, FELT), or (N, 0) where it does not matter
    begin: NDArray[np.intp]  # (N,) frame with which the episode begins
    longest: int  # frames of the longest episode
    digest: str  # of the files

    def __len__(self) -> int:
        return len(self.command)


def kept_frames(episode: Episode) -> NDArray[np.intp]:
    """Frames to train on: until shortly after the first success, pauses thinned."""
    reached = episode.meta.verdict.first_success_time
    times = episode.frames.time
    end = len(episode) if reached is None else int(np.searchsorted(times, reached)) + AFTER
    return thinned(episode.state[: min(max(end, 2), len(episode))])


def thinned(command: NDArray[np.floating]) -> NDArray[np.intp]:
    """Rows of a command (T, n) that remain when `PAUSE` are kept of every pause."""
    still = np.abs(np.diff(command, axis=0)).max(axis=1) < STILL  # row t + 1 repeats row t
    kept, run = [0], 1
    for row, pausing in enumerate(still, start=1):
        run = run + 1 if pausing else 1
        if run <= PAUSE:
            kept.append(row)
    return np.array(kept)


def load(
    dataset: Sequence[Episode],
    keep: Callable[[NDArray[np.uint8]], Arrays],
    feeling: bool = False,
) -> Demonstrations:
    """All frames of one task's episodes in memory.

    Args:
        keep: pictures (n, H, W, 3) of a camera to arrays of n rows that are kept of them.
        feeling: whether what was felt is kept; the dataset must have the sense of touch.

    Raises:
        ValueError: no episodes, or pictures that are too small.
        UnknownName: a camera is missing.
    """
    if not len(dataset):
        raise ValueError("the dataset holds no episode of this task")
    common = set.intersection(*(set(e.frames.object_poses) for e in dataset))
    names = sorted(name for name in common if not name.startswith("clutter"))
    kept = [kept_frames(episode) for episode in dataset]
    ends = np.cumsum([len(rows) for rows in kept])
    # Filled in place: parts that are joined at the end would need the memory twice.
    seen, parts = dict[str, Arrays](), []
    for episode, rows, end in zip(dataset, kept, ends, strict=True):
        felt = felt_frames(episode)[rows] if feeling else np.empty((len(rows), 0), np.float32)
        begin = np.full(len(rows), end - len(rows))
        parts.append(_numbers(episode, rows, names) | {"felt": felt, "begin": begin})
        for camera in PICTURES:
            arrays = keep(_pictures(camera, episode, rows))
            whole = seen.setdefault(
                camera, tuple(np.empty((ends[-1], *a.shape[1:]), a.dtype) for a in arrays)
            )
            for array, filled in zip(arrays, whole, strict=True):
                filled[end - len(rows) : end] = array
    joined = {key: np.concatenate([part[key] for part in parts]) for key in parts[0]}
    return Demonstrations(
        seen=seen,
        longest=max(len(rows) for rows in kept),
        digest=digest(dataset),
        **joined,
    )


def digest(dataset: Sequence[Episode]) -> str:
    """SHA-256 of all files that a network could learn from."""
    found = hashlib.sha256()
    for episode in dataset:
        for path in (episode.paths.hdf5, episode.paths.phys_meta):
            found.update(path.read_bytes())
    return found.hexdigest()


def _pictures(camera: str, episode: Episode, rows: NDArray[np.intp]) -> NDArray[np.uint8]:
    """A camera's pictures of these rows."""
    wanted = set(rows.tolist())
    frames = enumerate(episode.each_image(f"{camera}_camera"))
    return np.stack([shrink(camera, picture) for t, picture in frames if t in wanted])


def _numbers(episode: Episode, rows: NDArray[np.intp], names: list[str]) -> dict[str, NDArray]:
    command = episode.state[rows]
    ahead = np.minimum(np.arange(len(rows))[:, None] + np.arange(1, CHUNK + 1), len(rows) - 1)
    objects = np.concatenate([episode.poses(name)[rows, :3] for name in names], axis=1)
    return {
        "command": command.astype(np.float32),
        "following": command[ahead].astype(np.float32),
        "objects": objects.astype(np.float32),
    }
