"""Writes LeRobot datasets, v3.0 and v2.1, without torch or lerobot.

A frame pairs what a policy sees with what it must do: state and picture of instant t, command of
instant t + 1. `fps` and time stamps are those of 16.67 Hz in v2.1 and of 17 Hz in v3.0,
whose tools need a whole number.

Each episode is first written to files of its own, which are the layout of v2.1. A killed export
goes on with the next episode. For v3.0 the files are joined at the end, without encoding again. So
memory does not grow with the number of episodes.
"""

import shutil
from collections.abc import Callable, Iterable, Mapping, Sequence
from contextlib import ExitStack
from dataclasses import asdict, dataclass, fields, replace
from pathlib import Path

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq

from rtphys.assets.action_layout import SIDES
from rtphys.core.errors import BadFile, BadValue
from rtphys.core.untrusted import hidden, parse_mapping
from rtphys.data import files
from rtphys.data.dataset import Dataset, Episode
from rtphys.data.json_text import check_spelled, compact, plain, pretty
from rtphys.data.layout import MANIFEST
from rtphys.data.lock import FolderLock
from rtphys.data.video import VideoJoiner
from rtphys.export.lerobot_episode import (
    Counts,
    Position,
    Stats,
    columns_of,
    encode,
    frame_table,
    labels,
    none_counted,
    of_numbers,
    of_pixels,
    record_table,
    sentences_of,
    table_columns,
    to_json,
    write_table,
)
from rtphys.export.lerobot_plan import PICTURE, ExportSpec, Plan, plan_for

Progress = Callable[[int, int], None]  # episodes done, episodes in total
SPEC = "meta/rtphys.json"  # what an export holds of which dataset
CHUNK = 1000  # files in a folder (v3.0), episodes in a folder (v2.1)
DATA_MB, VIDEO_MB = 100, 50  # of v3.0: size above which the next file is begun
ROW_GROUP = 16_000_000  # [bytes] of a group of rows in memory
EPISODE_GROUP = 256  # rows of the table of episodes
DATA_V21 = "data/chunk-{episode_chunk:03d}/episode_{episode_index:06d}.parquet"
VIDEO_V21 = "videos/chunk-{episode_chunk:03d}/{video_key}/episode_{episode_index:06d}.mp4"
DATA_V30 = "data/chunk-{chunk_index:03d}/file-{file_index:03d}.parquet"
VIDEO_V30 = "videos/{video_key}/chunk-{chunk_index:03d}/file-{file_index:03d}.mp4"
EPISODES_V30 = "meta/episodes/chunk-000/file-000.parquet"


def export_lerobot(
    dataset: Dataset,
    out: Path,
    spec: ExportSpec = ExportSpec(),
    progress: Progress | None = None,
    notice: Callable[[str], None] = lambda _: None,
) -> Path:
    """Write a LeRobot dataset into a new folder, which appears complete or not at all.

    The same call after a kill goes on where it ended. `notice` is given a line about what is left
    out.

    Raises `UnknownName`, `BadValue`: see `plan_for`; `out` is not empty, or no UTF-8 text;
    `DatasetLocked`: another export writes there; `BadFile`: the dataset has no episode, or one is
    damaged, or lacks a number of others.
    """
    if not len(dataset):
        raise BadFile(dataset.path, "the dataset has no episode to export")
    plan = plan_for(dataset, spec)
    if plan.left_out:
        names = ", ".join(plan.left_out)
        notice(
            f"left out of the physics of each frame, since the asset's own is no number: {names}"
        )
    out = out.resolve()  # "." has no name, and a link may lead to another disk
    cure = "Parquet's reader takes no path that is not UTF-8; name another folder"
    check_spelled("out", str(out), cure)
    files.make_folder(out.parent)
    with FolderLock(out, hidden(out, ".lock")):
        with files.refusals(out):
            full = out.exists() and any(out.iterdir())
        if full:
            raise BadValue("out", str(out), "it is not empty; delete it, or name a new folder")
        part = hidden(out, files.TEMPORARY)
        parts = _Parts(part, spec, plan)
        parts.begin(dataset)
        for done, episode in enumerate(dataset, start=1):
            if done > len(parts.records):
                parts.add(replace(episode))  # a copy, which takes what was read of it with it
            if progress:
                progress(done, len(dataset))
        with files.refusals(out):
            whole = _v21(parts) if spec.version == "v2.1" else _v30(parts, part / "whole")
            if out.exists():
                out.rmdir()
            whole.rename(out)
        shutil.rmtree(part)
    return out


# ---- episodes one by one -------------------------------------------------------------------------


@dataclass(frozen=True)
class _Record:
    """What is known of an episode that was written."""

    rows: int
    sentences: Sequence[str]
    labels: Mapping[str, object]


class _Parts:
    """Episodes in files of their own, in the layout of v2.1, each with a record written last.

    Records lie outside the folder that becomes the export, so that a failed rename loses none.
    """

    def __init__(self, part: Path, spec: ExportSpec, plan: Plan) -> None:
        self.root, self._records = part / "episodes", part / "records"
        self.spec, self.plan = spec, plan
        self.records: list[_Record] = []
        self.tasks: dict[str, int] = {}  # sentence -> index
        self.frames = 0

    def path(self, form: str, episode: int, key: str = "") -> Path:
        """`DATA_V21` or `VIDEO_V21` of an episode."""
        where = {"episode_chunk": episode // CHUNK, "episode_index": episode, "video_key": key}
        return self.root / form.format(**where)

    def _record(self, episode: int) -> Path:
        return self._records / f"{episode:06d}.json"

    def begin(self, dataset: Dataset) -> None:
        """Take over the episodes of a killed export; those of another one are removed."""
        source = files.facts_of(dataset.path / MANIFEST).sha256
        order = [[episode.task, episode.config, episode.seed] for episode in dataset]
        # Of another robot, the same tasks and seeds may be there.
        what = {"export": asdict(self.spec), "robot": self.plan.robot}
        text = pretty(plain({**what, "manifest": source, "episodes": order}))
        path = self.root / SPEC
        if not (path.is_file() and files.read(path) == text):
            shutil.rmtree(self.root.parent, ignore_errors=True)
            for folder in (path.parent, self._records):
                files.make_folder(folder)
            files.replace_file(path, text)
        while (path := self._record(len(self.records))).is_file():
            stored = parse_mapping(files.read(path), path)
            self._take(_Record(*(stored[f.name] for f in fields(_Record))))  # type: ignore[arg-type]

    def _take(self, record: _Record) -> None:
        self.records.append(record)
        for sentence in record.sentences:
            self.tasks.setdefault(sentence, len(self.tasks))
        self.frames += record.rows

    def add(self, episode: Episode) -> None:
        """Write one episode."""
        number, sentences = len(self.records), sentences_of(episode, self.spec.sentences)
        known = {**self.tasks}
        tasks = tuple(known.setdefault(sentence, len(known)) for sentence in sentences)
        columns = columns_of(episode, Position(number, self.frames, tasks), self.plan)
        made = encode(episode, self.plan)
        for key, (video, _) in made.items():
            path = self.path(VIDEO_V21, number, key)
            files.make_folder(path.parent)
            files.write_synced(path, video)
        write_table(frame_table(columns), self.path(DATA_V21, number))
        pixels = {key: counts.tolist() for key, (_, counts) in made.items()}
        record = _Record(len(columns["index"]), sentences, labels(episode))
        text = pretty(plain({**asdict(record), "pixels": pixels}), sort=False, indent=0)
        files.replace_file(self._record(number), text)
        self._take(record)

    def pixels(self, episode: int) -> dict[str, Counts]:
        """Counts of an episode's pixels by video."""
        path = self._record(episode)
        stored = parse_mapping(files.read(path), path)["pixels"]
        return {key: np.array(counts, np.int64) for key, counts in stored.items()}  # type: ignore[union-attr]

    def stats(self, episode: int) -> dict[str, Stats]:
        """Statistics of an episode by feature, pictures included."""
        columns = table_columns(pq.read_table(self.path(DATA_V21, episode)))
        found = {name: of_numbers(values) for name, values in columns.items()}
        rows = self.records[episode].rows
        return found | {key: of_pixels(one, rows) for key, one in self.pixels(episode).items()}

    def info(self, version: str, data_path: str, video_path: str) -> dict[str, object]:
        """What `meta/info.json` says in both versions."""
        return {
            "codebase_version": version,
            "robot_type": self.plan.robot,
            "total_episodes": len(self.records),
            "total_frames": self.frames,
            "total_tasks": len(self.tasks),
            "chunks_size": CHUNK,
            "fps": float(self.plan.rate),
            "splits": {"train": f"0:{len(self.records)}"},
            "data_path": data_path,
            "video_path": video_path,
            "features": self.plan.features(),
        }


# ---- v2.1 ----------------------------------------------------------------------------------------


def _v21(parts: _Parts) -> Path:
    """Write the files in `meta/`; the episodes are in place. Returns the finished folder."""
    meta, plan, total = parts.root / "meta", parts.plan, len(parts.records)
    episodes = (
        {"episode_index": n, "tasks": one.sentences, "length": one.rows, **one.labels}
        for n, one in enumerate(parts.records)
    )
    stats = (
        {"episode_index": n, "stats": {key: to_json(s) for key, s in parts.stats(n).items()}}
        for n in range(total)
    )
    tasks = ({"task_index": n, "task": text} for text, n in parts.tasks.items())
    lines: dict[str, Iterable[Mapping[str, object]]] = {
        "episodes.jsonl": episodes,
        "episodes_stats.jsonl": stats,
        "tasks.jsonl": tasks,
    }
    for name, rows in lines.items():
        with (meta / name).open("wb") as file:
            file.writelines(compact(plain(row)) + b"\n" for row in rows)
    # GR00T's slices of the vectors.
    slices: dict[str, object] = {}
    layout = plan.layout
    for side, arm, gripper in zip(SIDES, layout.arms, layout.grippers, strict=True):
        slices[f"{side}_arm"] = {"start": arm.start, "end": arm.stop}
        slices[f"{side}_gripper"] = {"start": gripper, "end": gripper + 1}
    videos = {key.removeprefix(PICTURE): {"original_key": key} for key in plan.videos}
    annotation = {"human.task_description": {"original_key": "task_index"}}
    modality = {"state": slices, "action": slices, "video": videos, "annotation": annotation}
    files.write_synced(meta / "modality.json", pretty(plain(modality)))
    info = parts.info("v2.1", DATA_V21, VIDEO_V21)
    info |= {"total_videos": total * len(plan.videos), "total_chunks": -(-total // CHUNK)}
    files.write_synced(meta / "info.json", pretty(plain(info), sort=False))
    return parts.root


# ---- v3.0 ----------------------------------------------------------------------------------------


def _v30(parts: _Parts, root: Path) -> Path:
    """Join the episodes' files and write those in `meta/`. Returns the finished folder."""
    shutil.rmtree(root, ignore_errors=True)
    ends = np.cumsum([one.rows for one in parts.records]).tolist()
    records: list[dict[str, object]] = [
        {
            "episode_index": n,
            "tasks": one.sentences,
            "length": one.rows,
            "dataset_from_index": ends[n] - one.rows,
            "dataset_to_index": ends[n],
            "meta/episodes/chunk_index": 0,
            "meta/episodes/file_index": 0,
            **one.labels,
        }
        for n, one in enumerate(parts.records)
    ]
    tables = _join_tables(parts, root, records)
    for key in parts.plan.videos:
        _join_videos(parts, root, key, records)
    _write_episodes(parts, root / EPISODES_V30, records)
    tasks = record_table([{"task_index": n, "task": text} for text, n in parts.tasks.items()])
    write_table(tasks.replace_schema_metadata(INDEXED), root / "meta" / "tasks.parquet")
    stats: dict[str, Stats] = {}
    for name in pq.read_schema(tables[0]).names:
        read = [table_columns(pq.read_table(path, columns=[name]))[name] for path in tables]
        stats[name] = of_numbers(np.concatenate(read))
    total = {key: none_counted(video) for key, video in parts.plan.videos.items()}
    for n in range(len(records)):
        for key, counts in parts.pixels(n).items():
            total[key] += counts
    stats |= {key: of_pixels(counts, parts.frames) for key, counts in total.items()}
    plain_stats = {name: to_json(part) for name, part in stats.items()}
    files.write_synced(root / "meta" / "stats.json", pretty(plain(plain_stats)))
    info = parts.info("v3.0", DATA_V30, VIDEO_V30)
    info |= {"data_files_size_in_mb": DATA_MB, "video_files_size_in_mb": VIDEO_MB}
    files.write_synced(root / "meta" / "info.json", pretty(plain(info), sort=False))
    files.write_synced(root / SPEC, files.read(parts.root / SPEC))
    return root


def _at(number: int) -> dict[str, int]:
    """Chunk and index of the nth file."""
    return {"chunk_index": number // CHUNK, "file_index": number % CHUNK}


def _join_tables(parts: _Parts, root: Path, records: list[dict[str, object]]) -> list[Path]:
    """Write the frames of all episodes in few files, and into records where they are."""
    written: list[Path] = []
    held: list[pa.Table] = []
    total = 0
    with ExitStack() as open_file:
        writer: pq.ParquetWriter | None = None
        for n, record in enumerate(records):
            table = pq.read_table(parts.path(DATA_V21, n))
            if writer is None:
                path = root / DATA_V30.format(**_at(len(written)))
                files.make_folder(path.parent)
                written.append(path)
                writer = open_file.enter_context(pq.ParquetWriter(path, table.schema))
            held, total = [*held, table], total + table.nbytes
            record |= {f"data/{key}": value for key, value in _at(len(written) - 1).items()}
            full, last = total > DATA_MB * 1_000_000, n + 1 == len(records)
            if full or last or sum(one.nbytes for one in held) > ROW_GROUP:
                writer.write_table(pa.concat_tables(held))
                held = []
            if full:
                open_file.close()
                writer, total = None, 0
    return written


def _join_videos(parts: _Parts, root: Path, key: str, records: list[dict[str, object]]) -> None:
    """Write a video of all episodes in few files, and into records where they are."""
    rate = float(parts.plan.rate)
    number, first = 0, 0
    joined: VideoJoiner | None = None
    for n, record in enumerate(records):
        rows = parts.records[n].rows
        place = {f"videos/{key}/{name}": value for name, value in _at(number).items()}
        place |= {f"videos/{key}/from_timestamp": first / rate}
        record |= {**place, f"videos/{key}/to_timestamp": (first + rows) / rate}
        first += rows
        path = root / VIDEO_V30.format(video_key=key, **_at(number))
        if joined is None:
            path.parent.mkdir(parents=True, exist_ok=True)
            joined = VideoJoiner(path, parts.plan.rate)
        joined.add(files.read(parts.path(VIDEO_V21, n, key)))
        if joined.size > VIDEO_MB * 1_000_000 or n + 1 == len(records):
            joined.finish()
            number, first, joined = number + 1, 0, None


def _write_episodes(parts: _Parts, path: Path, records: list[dict[str, object]]) -> None:
    """Write the table of episodes with the statistics of each, a group of rows at a time."""
    small = record_table(records)
    files.make_folder(path.parent)
    with ExitStack() as open_file:
        writer: pq.ParquetWriter | None = None
        for start in range(0, len(records), EPISODE_GROUP):
            table = small.slice(start, EPISODE_GROUP)
            found = [parts.stats(n) for n in range(start, start + len(table))]
            for feature, first in found[0].items():
                for name in first:
                    values = [stats[feature][name].tolist() for stats in found]
                    table = table.append_column(f"stats/{feature}/{name}", pa.array(values))
            if writer is None:
                writer = open_file.enter_context(pq.ParquetWriter(path, table.schema))
            writer.write_table(table)


_PANDAS = {
    "index_columns": ["task"],
    "column_indexes": [],
    "columns": [
        {"name": "task_index", "field_name": "task_index", "pandas_type": "int64",
         "numpy_type": "int64", "metadata": None},
        {"name": "task", "field_name": "task", "pandas_type": "unicode",
         "numpy_type": "object", "metadata": None},
    ],
    "creator": {"library": "pyarrow", "version": pa.__version__},
    "pandas_version": "2.0.0",
}  # fmt: skip
INDEXED = {b"pandas": pretty(plain(_PANDAS))}
"""Marks the column `task` as pandas' index, by which LeRobot looks tasks up."""
