"""One episode in LeRobot's format: columns, pictures, statistics, and the tables that hold them."""

from collections.abc import Iterator, Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from itertools import islice
from pathlib import Path
from typing import Any

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
from numpy.typing import NDArray

from rtphys.core.errors import BadFile
from rtphys.data.dataset import Episode
from rtphys.data.files import make_folder, write_synced
from rtphys.data.schema import informs
from rtphys.data.video import VideoWriter
from rtphys.export.lerobot_plan import DEPTH_MOST, EXPORTED, PHYSICS, Plan, Video, physics_of

Columns = dict[str, np.ndarray]
Stats = dict[str, NDArray[np.float64]]
Counts = NDArray[np.int64]  # (channels, levels) pixels by value
QUANTILES = {"q01": 0.01, "q10": 0.10, "q50": 0.50, "q90": 0.90, "q99": 0.99}
STRIDE = 4  # of a picture's rows and columns, every so many are counted
KEYFRAMES = 2  # as LeRobot encodes: every second picture is a key frame


@dataclass(frozen=True)
class Position:
    """Indices of an episode within the export."""

    episode: int
    first: int  # index of its first frame among all frames
    tasks: tuple[int, ...]  # of its sentences, which take turns from frame to frame


def columns_of(episode: Episode, at: Position, plan: Plan) -> Columns:
    """Frame columns of an episode, T - 1 rows: the last frame has no action and is left out.

    Raises `BadFile`: the physics was asked for, and has other attributes.
    """
    frames, more = episode.frames, Columns()
    rows = len(frames) - 1
    for feature in set(PHYSICS) & set(plan.more):
        physics = physics_of(episode)
        numbers = {name: value for name, value in physics.items() if name not in plan.left_out}
        if [*numbers] != list(plan.more[feature]):
            raise BadFile(episode.paths.phys_meta, "has other attributes than the first episode")
        more[feature] = np.tile(np.array([*numbers.values()], np.float32), (rows, 1))
    if "observation.contact" in plan.more:
        touched = np.any(list(frames.contacts.values()), axis=0)
        more["observation.contact"] = touched[:-1].astype(np.float32)
    for name in EXPORTED:
        if (key := f"observation.{name}") in plan.more:
            columns = episode.senses.columns(name)
            if list(columns) != list(plan.more[key]):
                raise BadFile(episode.paths.hdf5, f"has other columns of {name} than the first")
            more[key] = np.stack([*columns.values()], axis=1)[:-1]
    ee = np.concatenate([frames.left_endpose, frames.right_endpose], axis=1)
    order = np.arange(rows)
    return {
        "observation.state": frames.vector[:-1].astype(np.float32),
        "observation.ee_pose": ee[:-1].astype(np.float32),
        "observation.effort": frames.effort[:-1].astype(np.float32),
        "action": frames.vector[1:].astype(np.float32),
        **more,
        "timestamp": (order / float(plan.rate)).astype(np.float32),
        "frame_index": order,
        "episode_index": np.full(rows, at.episode),
        "index": at.first + order,
        "task_index": np.array(at.tasks)[order % len(at.tasks)],
    }


def pictures_of(episode: Episode, video: Video) -> Iterator[NDArray[Any]]:
    """What a video shows, T - 1 pictures: (H, W, 3) RGB, or depths (H, W) uint16 [mm]."""
    rows = len(episode) - 1
    if not video.depth:
        yield from islice(episode.each_image(video.camera), rows)
        return
    for frame in range(rows):
        metres = episode.senses.depth(video.camera, frame)
        yield np.rint(metres * 1000).clip(0, DEPTH_MOST).astype(np.uint16)


def encode(episode: Episode, plan: Plan) -> dict[str, tuple[bytes, Counts]]:
    """The MP4 of each video, and how many of its pixels have each value.

    Each video has a thread: decoding and encoding release the GIL.
    """

    def work(video: Video) -> tuple[bytes, Counts]:
        writer = VideoWriter(*plan.size, plan.rate, KEYFRAMES, depth=video.depth)
        counts = none_counted(video)
        for picture in pictures_of(episode, video):
            writer.add(picture)
            count(counts, picture)
        return writer.finish(), counts

    with ThreadPoolExecutor(len(plan.videos)) as pool:
        return dict(zip(plan.videos, pool.map(work, plan.videos.values()), strict=True))


def sentences_of(episode: Episode, which: str) -> list[str]:
    """LeRobot's "tasks" of an episode: its "first" sentence, "all", or the "task"'s name."""
    name, seen = episode.task.replace("_", " "), list(episode.instructions.seen)
    if which == "task" or not seen:
        return [name]
    return list(dict.fromkeys(seen)) if which == "all" else seen[:1]


def labels(episode: Episode) -> dict[str, object]:
    """Episode columns beyond LeRobot's own: physics as `phys/<key>`, origin as `rtphys/<key>`.

    The value is None where an attribute could not act or did not act, as in `Dataset.to_pandas`.
    """
    origin = {key: getattr(episode, key) for key in ("task", "protocol", "config", "seed")}
    labels = episode.meta.attributes.items()
    values = {key: label.value if informs(key, label) else None for key, label in labels}
    return {
        **{f"rtphys/{key}": value for key, value in origin.items()},
        **{f"phys/{key}": value for key, value in values.items()},
    }


# ---- statistics: min, max, mean, std, count, five quantiles --------------------------------------


def of_numbers(values: NDArray[np.floating]) -> Stats:
    """Statistics of numbers (T, n): (n,) each, count (1,)."""
    rows = np.asarray(values, np.float64).reshape(len(values), -1)
    quantiles = np.quantile(rows, list(QUANTILES.values()), axis=0)
    return {
        "min": rows.min(axis=0),
        "max": rows.max(axis=0),
        "mean": rows.mean(axis=0),
        "std": rows.std(axis=0),
        "count": np.array([len(rows)], np.float64),
        **dict(zip(QUANTILES, quantiles, strict=True)),
    }


def none_counted(video: Video) -> Counts:
    """Counts of no picture."""
    return np.zeros((1, DEPTH_MOST + 1) if video.depth else (3, 256), np.int64)


def count(counts: Counts, picture: NDArray[np.unsignedinteger]) -> None:
    """Add the pixels of a picture (H, W) or (H, W, channels), every `STRIDE`th row and column."""
    channels, levels = counts.shape
    sparse = picture[::STRIDE, ::STRIDE].reshape(-1, channels)
    counts += [np.bincount(sparse[:, c], minlength=levels) for c in range(channels)]


def of_pixels(counts: Counts, pictures: int) -> Stats:
    """Statistics of pixels, (channels, 1, 1) each, count (1,): colours 0..1, depths [mm]."""
    channels, levels = counts.shape
    value = np.arange(levels) / (255 if channels == 3 else 1)
    share = counts / counts.sum(axis=1, keepdims=True)
    mean = share @ value
    cumulative = share.cumsum(axis=1)
    stats = {
        "min": np.array([value[row.nonzero()[0][0]] for row in counts]),
        "max": np.array([value[row.nonzero()[0][-1]] for row in counts]),
        "mean": mean,
        "std": np.sqrt(np.maximum(share @ value**2 - mean**2, 0)),
        **{name: value[(cumulative >= q - 1e-12).argmax(axis=1)] for name, q in QUANTILES.items()},
    }
    shaped = {name: part.reshape(channels, 1, 1) for name, part in stats.items()}
    return {**shaped, "count": np.array([pictures], np.float64)}


def to_json(stats: Stats) -> dict[str, object]:
    """Statistics as lists, the count as a list of one integer."""
    return {
        name: [int(value[0])] if name == "count" else value.tolist()
        for name, value in stats.items()
    }


# ---- tables with fixed types: a column without values keeps its type -----------------------------


def frame_table(columns: Mapping[str, np.ndarray]) -> pa.Table:
    """Table of frame columns, (T,) or (T, n) each; vectors become lists of fixed length."""
    arrays = {}
    for name, values in columns.items():
        flat = pa.array(np.ascontiguousarray(values).ravel())
        wide = values.ndim == 2
        arrays[name] = pa.FixedSizeListArray.from_arrays(flat, values.shape[1]) if wide else flat
    return pa.table(arrays)


def table_columns(table: pa.Table) -> Columns:
    """Inverse of `frame_table`."""
    found: Columns = {}
    for name in table.column_names:
        column = table[name].combine_chunks()
        if pa.types.is_fixed_size_list(column.type):
            found[name] = column.flatten().to_numpy().reshape(len(column), -1)
        else:
            found[name] = column.to_numpy()
    return found


def record_table(rows: Sequence[Mapping[str, object]]) -> pa.Table:
    """Table with one row per record of numbers, text and lists; a key that one lacks is null."""
    columns = {}
    for key in dict.fromkeys(key for row in rows for key in row):
        values = [row.get(key) for row in rows]
        # Floats if all values are null, such as the asset's own damping; else inferred.
        kind = pa.float64() if all(value is None for value in values) else None
        columns[key] = pa.array(values, kind)
    return pa.table(columns)


def write_table(table: pa.Table, path: Path) -> None:
    """Write a table as Parquet. Raises `CannotWrite`."""
    make_folder(path.parent)
    pq.write_table(table, sink := pa.BufferOutputStream(), compression="snappy")
    write_synced(path, sink.getvalue().to_pybytes())
