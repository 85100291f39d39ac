"""Reads a LeRobot v2.1 folder by `meta/modality.json`, as GR00T's loader does: its rules, our code.

Only files and the metadata are asked; nothing of rtphys is.
"""

import json
from collections.abc import Sequence
from pathlib import Path

import av
import numpy as np
import pyarrow.parquet as pq


class Reader:
    """A dataset of trajectories, each a table and one video a view."""

    def __init__(self, root: Path) -> None:
        self.root = root
        self.info = json.loads((root / "meta/info.json").read_text())
        self.modality = json.loads((root / "meta/modality.json").read_text())
        self.tasks = {row["task_index"]: row["task"] for row in self._lines("tasks")}
        self.lengths = {row["episode_index"]: row["length"] for row in self._lines("episodes")}

    def _lines(self, name: str) -> list[dict]:
        text = (self.root / "meta" / f"{name}.jsonl").read_text()
        return [json.loads(line) for line in text.splitlines()]

    def _table(self, episode: int):
        chunk = episode // self.info["chunks_size"]
        name = self.info["data_path"].format(episode_chunk=chunk, episode_index=episode)
        return pq.read_table(self.root / name)

    def part(self, episode: int, modality: str, key: str, rows: Sequence[int]) -> np.ndarray:
        """A slice of the state or action vector at some rows; rows beyond the end repeat it."""
        entry = self.modality[modality][key]
        usual = {"state": "observation.state", "action": "action"}[modality]
        column = self._table(episode)[entry.get("original_key", usual)]
        values = np.stack([np.asarray(row) for row in column.to_pylist()])
        at = np.clip(rows, 0, self.lengths[episode] - 1)
        return values[at, entry["start"] : entry["end"]]

    def frames(self, episode: int, view: str, rows: Sequence[int]) -> np.ndarray:
        """Pictures of a view, found by the rows' time stamps as a video reader finds them."""
        key = self.modality["video"][view].get("original_key", f"observation.images.{view}")
        chunk = episode // self.info["chunks_size"]
        spot = {"episode_chunk": chunk, "episode_index": episode, "video_key": key}
        wanted = np.asarray(self._table(episode)["timestamp"].to_pylist())[list(rows)]
        with av.open(str(self.root / self.info["video_path"].format(**spot))) as container:
            shown = [(frame.time, frame.to_ndarray(format="rgb24")) for frame in container.decode()]
        times = np.array([time for time, _ in shown])
        return np.stack([shown[int(np.abs(times - t).argmin())][1] for t in wanted])

    def size(self, view: str) -> tuple[int, int, int, float]:
        """Height, width, channels and rate that the metadata declares."""
        feature = self.info["features"][self.modality["video"][view]["original_key"]]
        shape, names = feature["shape"], feature["names"]
        height, width, channels = (shape[names.index(n)] for n in ("height", "width", "channels"))
        return height, width, channels, feature["info"]["video.fps"]

    def sentence(self, episode: int, key: str, row: int) -> str:
        """The annotation of a row: an index into the tasks."""
        column = self.modality["annotation"][key].get("original_key", f"annotation.{key}")
        return self.tasks[self._table(episode)[column].to_pylist()[row]]
