"""CPU and wall time of a LeRobot v3.0 export, compared with encoding its videos with PyAV.

    python benchmarks/export.py [DATASET]

PyAV encodes pictures from memory with `from_ndarray`, as LeRobot does itself, with the same encoder
and the same specs. Without a dataset, typical episodes are collected.
"""

import math
import sys
import tempfile
import time
from collections.abc import Callable, Sequence
from io import BytesIO
from pathlib import Path

import av
import numpy as np
from av.video.stream import VideoStream
from typical import typical

from rtphys.data.dataset import Dataset, Episode
from rtphys.data.video import CRF, PRESET, VideoWriter
from rtphys.export.lerobot import export_lerobot
from rtphys.export.lerobot_episode import KEYFRAMES
from rtphys.export.lerobot_plan import RATES

ROUNDS, RATE = 3, RATES["v3.0"]


def spent(work: Callable[[], object]) -> np.ndarray:
    """CPU time of this process, summed over its threads, and wall time: (2,) [s]."""
    start = np.array([time.process_time(), time.perf_counter()])
    work()
    return np.array([time.process_time(), time.perf_counter()]) - start


def plain(episodes: Sequence[Episode], camera: str) -> np.ndarray:
    """CPU and wall time that PyAV takes to encode a camera's pictures as one video: (2,) [s]."""
    container = av.open(BytesIO(), "w", format="mp4")
    stream = container.add_stream("libx264", rate=RATE)
    assert isinstance(stream, VideoStream)
    stream.height, stream.width = episodes[0].image(camera, 0).shape[:2]
    stream.pix_fmt, keys = "yuv420p", {"g": str(KEYFRAMES), "bf": "0"}
    stream.options = {"preset": PRESET, "crf": CRF, "threads": "1", **keys}
    total = np.zeros(2)
    for episode in episodes:
        pictures = [*episode.each_image(camera)][:-1]

        def encode(pictures: list = pictures) -> None:
            for picture in pictures:
                container.mux(stream.encode(av.VideoFrame.from_ndarray(picture, format="rgb24")))

        total += spent(encode)
    return total + spent(lambda: (container.mux(stream.encode()), container.close()))


def own(episodes: Sequence[Episode], camera: str) -> np.ndarray:
    """CPU and wall time that rtphys takes to encode the same pictures: (2,) [s]."""
    height, width, _ = episodes[0].image(camera, 0).shape
    writer, total = VideoWriter(height, width, RATE, KEYFRAMES), np.zeros(2)
    for episode in episodes:
        pictures = [*episode.each_image(camera)][:-1]
        total += spent(lambda p=pictures: [writer.add(picture) for picture in p])
    return total + spent(writer.finish)


def main(path: str | None = None) -> None:
    with tempfile.TemporaryDirectory() as folder:
        data = Dataset(typical(path, folder))
        cameras = data[0].cameras
        pictures = sum(len(episode) - 1 for episode in data) * len(cameras)
        costs: dict[str, np.ndarray] = dict.fromkeys(
            ("PyAV", "own", "export"), np.full(2, math.inf)
        )
        for turn in range(ROUNDS):  # alternating, and the minimum of each: other programs disturb
            out = Path(folder) / str(turn)
            measured: dict[str, np.ndarray] = {
                "PyAV": np.sum([plain(data, camera) for camera in cameras], axis=0),
                "own": np.sum([own(data, camera) for camera in cameras], axis=0),
                "export": spent(lambda out=out: export_lerobot(Dataset(data.path), out)),
            }
            costs = {name: np.minimum(costs[name], measured[name]) for name in measured}
    for name, seconds in costs.items():
        share, each = seconds / costs["PyAV"], 1e3 * seconds / pictures
        print(
            f"{name:8} {each[0]:6.3f} CPU-ms per picture, {share[0]:.2f} of PyAV's; "
            f"{each[1]:6.3f} ms of wall time, {share[1]:.2f}"
        )


if __name__ == "__main__":
    main(*sys.argv[1:2])
