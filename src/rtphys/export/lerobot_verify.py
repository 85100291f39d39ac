"""Compares a LeRobot export with the dataset that it was made of: every number, every picture."""

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import replace
from functools import lru_cache
from itertools import islice
from math import isfinite
from pathlib import Path

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
from numpy.typing import NDArray

from rtphys.core.errors import BadFile, BadValue, short_repr
from rtphys.core.untrusted import parse_mapping
from rtphys.data import files, video
from rtphys.data.dataset import Dataset, Episode
from rtphys.data.layout import MANIFEST
from rtphys.export.lerobot import CHUNK, EPISODES_V30, SPEC, Progress
from rtphys.export.lerobot_episode import (
    Position,
    columns_of,
    labels,
    pictures_of,
    sentences_of,
)
from rtphys.export.lerobot_plan import ExportSpec, Plan, plan_for
from rtphys.spec.stored import load

Picture = NDArray[np.uint8 | np.uint16]
# H.264 at the export's quality is off by about 2 of 255 in drawn pictures, and by 12 in noise.
FAR = 16.0  # mean difference of a picture from its source, of 255, above which it is another one
CLOSER = 1.25  # times by which a neighbour or exchanged colours must fit better to be what is shown


def verify_export(out: Path, dataset: Dataset, progress: Progress | None = None) -> list[str]:
    """Every difference between an export and its dataset, a sentence each.

    Raises `BadFile`: it is no export of rtphys, or a file of either cannot be read; `BadValue`: the
    dataset has changed since, or is another one.
    """
    stored = parse_mapping(files.read(out / SPEC), out / SPEC)
    given, order = stored.get("export"), stored.get("episodes")
    if not isinstance(given, Mapping) or not isinstance(order, list):
        raise BadFile(out / SPEC, "does not say what was exported")
    if stored.get("manifest") != files.facts_of(dataset.path / MANIFEST).sha256:
        allowed = f"{out} was made of another dataset, or of another state of this one"
        raise BadValue("dataset", str(dataset.path), allowed)
    spec = load(ExportSpec, given, out / SPEC)
    export = _Export(out, spec.version, len(order))
    known = {(e.task, e.config, e.seed): e for e in dataset if e.embodiment == export.robot}
    try:
        episodes = [known[tuple(key)] for key in order]  # type: ignore[index, arg-type]
    except (KeyError, TypeError) as error:
        raise BadFile(out / SPEC, f"names an episode that the dataset lacks: {error}") from error
    plan = plan_for(episodes, spec)
    tasks: dict[str, int] = {}
    problems, first = list[str](), 0
    for number, episode in enumerate(map(replace, episodes)):  # copies, to forget what is read
        said = sentences_of(episode, spec.sentences)
        at = Position(number, first, tuple(tasks.setdefault(s, len(tasks)) for s in said))
        where = f"episode {number} ({episode.task}, seed {episode.seed})"
        record = {"tasks": said, "length": len(episode) - 1, **labels(episode)}
        found = (*export.record_differences(number, record), *export.differences(episode, at, plan))
        problems += [f"{where}: {text}" for text in found]
        first += len(episode) - 1
        if progress:
            progress(number + 1, len(episodes))
    if export.tasks() != tasks:
        problems.append("the list of sentences is not the dataset's")
    return problems


class _Export:
    """An export's files, found by its own metadata.

    Raises `BadFile`: other episodes are there, or it does not say where one lies.
    """

    def __init__(self, out: Path, version: str, episodes: int) -> None:
        self._out, self._table = out, lru_cache(maxsize=2)(_table)
        self._info_path = path = out / "meta/info.json"
        self._info = parse_mapping(files.read(path), path)
        if (total := self._info.get("total_episodes")) != episodes:
            raise BadFile(path, f"holds {total} episodes, not {episodes}")
        self.robot = self._info.get("robot_type")
        self._v30 = version == "v3.0"
        self._rows = self._listed(EPISODES_V30, "meta/episodes.jsonl")
        if len(self._rows) != episodes:
            raise BadFile(path, f"its table lists {len(self._rows)} episodes, not {episodes}")
        self._reels: dict[str, tuple[Path, int, Iterator[Picture]]] = {}  # where decoding stands

    def _listed(self, v30: str, v21: str) -> Sequence[Mapping[str, object]]:
        """The rows of a table in `meta/`, each version's own. Raises `BadFile`."""
        if self._v30:
            return self._table(self._out / v30).to_pylist()
        path = self._out / v21
        return [parse_mapping(line, path) for line in files.read(path).splitlines()]

    def tasks(self) -> dict[object, object]:
        """Sentence -> index."""
        rows = self._listed("meta/tasks.parquet", "meta/tasks.jsonl")
        return {row.get("task"): row.get("task_index") for row in rows}

    def record_differences(self, number: int, wanted: Mapping[str, object]) -> Iterator[str]:
        """What the table of episodes says of one that the dataset does not."""
        row = self._rows[number]
        own = [key for key in row if key.startswith(("phys/", "rtphys/"))]
        for key in dict.fromkeys([*wanted, *own]):
            if row.get(key) != wanted.get(key):
                yield f"{key} is not the dataset's"

    def differences(self, episode: Episode, at: Position, plan: Plan) -> Iterator[str]:
        """What an episode's rows and pictures say that the dataset does not."""
        wanted = columns_of(episode, at, plan)
        rows = len(wanted["index"])
        path = self._path("data", at.episode)
        table = self._table(path)
        begins = _numbers(table["index"][:1]) if "index" in table.column_names else None
        if begins is None or begins.shape != (1,):
            raise BadFile(path, "holds no index of its frames")
        own = table.slice(max(at.first - int(begins[0]), 0), rows)
        for name in dict.fromkeys([*wanted, *own.column_names]):
            found = _numbers(own[name]) if name in own.column_names and name in wanted else None
            if found is None or not np.array_equal(found, wanted[name]):
                yield f"{name} is not the dataset's"
        for key, of in plan.videos.items():
            name = f"{of.camera}, depth" if of.depth else of.camera
            shown = list(self._pictures(key, at.episode, rows))
            for text in _different(shown, pictures_of(episode, of), 0 if of.depth else FAR):
                yield f"{name}, {text}"

    def _path(self, kind: str, episode: int, key: str = "") -> Path:
        """The file of an episode's "data" or "video"."""
        chunk = {"episode_chunk": episode // CHUNK, "episode_index": episode}
        if self._v30:
            place = f"videos/{key}" if key else kind
            both = ("chunk_index", "file_index")
            chunk = {one: int(self._said(episode, f"{place}/{one}")) for one in both}
        form = self._info.get(f"{kind}_path")
        try:
            return self._out / str.format(form, video_key=key, **chunk)  # type: ignore[arg-type]
        except (TypeError, KeyError, IndexError, ValueError) as error:
            problem = f"{kind}_path is {short_repr(form)}, which names no file of an episode"
            raise BadFile(self._info_path, problem) from error

    def _said(self, episode: int, key: str) -> float:
        """What the table of episodes says of one. Raises `BadFile`: it is no number."""
        return _number(self._rows[episode], key, self._out / EPISODES_V30)

    def _pictures(self, key: str, episode: int, rows: int) -> Iterator[Picture]:
        """An episode's pictures; a file that holds several is decoded once."""
        path = self._path("video", episode, key)
        start = 0
        if self._v30:
            begins = self._said(episode, f"videos/{key}/from_timestamp")
            start = round(begins * _number(self._info, "fps", self._info_path))
        before, position, reel = self._reels.get(key, (None, 0, iter(())))
        if (before, position) != (path, start):
            reel = islice(_decoded(path), start, None)
        self._reels[key] = (path, start + rows, reel)
        return islice(reel, rows)


def _different(shown: list[Picture], truths: Iterable[Picture], far: float) -> Iterator[str]:
    """Pictures that are not those of their instants, or further than `far` from them."""
    before: Picture | None = None
    for t, truth in enumerate(truths):
        if t >= len(shown):
            yield f"frame {t} and later: the video ends"
            return
        error = _distance(shown[t], truth)
        if error > far:
            yield f"frame {t}: another picture (mean difference {error:.1f})"
        elif error and _distance(shown[t], truth[..., ::-1]) * CLOSER < error:
            yield f"frame {t}: red and blue are exchanged"
        elif before is not None and _distance(shown[t], before) * CLOSER < error:
            yield f"frame {t}: the picture of the frame before"
        before = truth


def _distance(one: Picture, other: Picture) -> float:
    return float(np.abs(one.astype(np.int32) - other).mean()) if one.shape == other.shape else 255.0


def _decoded(path: Path) -> Iterator[Picture]:
    """The pictures of a video. Raises `BadFile`."""
    try:
        yield from video.decode(files.read(path))
    except video.BadVideo as error:
        raise BadFile(path, str(error)) from error


def _number(said: Mapping[str, object], key: str, path: Path) -> float:
    """A number from 0 on. Raises `BadFile`: it is none."""
    value = said.get(key)
    if not isinstance(value, int | float) or not (isfinite(value) and value >= 0):
        raise BadFile(path, f"{key} is {short_repr(value)}, not a number from 0 on")
    return value


def _numbers(column: pa.ChunkedArray) -> NDArray[np.number] | None:
    """Numbers (T,), or (T, n) of lists of any kind, as another tool may write them; None: neither
    holds."""
    try:
        found = np.array(column.to_pylist())
    except ValueError:  # lists of several lengths
        return None
    return found if found.dtype.kind in "iuf" else None


def _table(path: Path) -> pa.Table:
    """A Parquet file. Raises `BadFile`."""
    try:
        return pq.read_table(path)
    except (pa.ArrowException, OSError) as error:
        raise BadFile(path, f"cannot be read: {error}") from error
