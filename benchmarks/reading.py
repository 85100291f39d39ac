"""Random access to pictures: items per CPU-second, rtphys.Dataset against LeRobot's dataset.

    python benchmarks/reading.py DATASET --lerobot PYTHON

Exports the dataset as LeRobot v3.0, then reads the same randomly chosen frames of both: three
pictures, state and action are an item. PYTHON is an interpreter that has lerobot, which reads by
PyAV; the time to import and open a dataset does not count. `first` includes the first visit of each
file, `later` reads the same items again.
"""

import argparse
import json
import os
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import numpy as np

import rtphys

CAMERAS = ("head_camera", "left_camera", "right_camera")
# Runs in the other interpreter, which may not have rtphys.
LEROBOT = """
import json, sys, time
from pathlib import Path
from lerobot.datasets.lerobot_dataset import LeRobotDataset

folder, rows = Path(sys.argv[1]), json.loads(sys.argv[2])
data = LeRobotDataset(f"{folder.parent.name}/{folder.name}", root=folder, video_backend="pyav")
rates = []
for _ in range(2):
    start = time.process_time()
    for row in rows:
        item = data[row]
    rates.append(len(rows) / (time.process_time() - start))
pictures = sum(key.startswith("observation.images") for key in item)
print(json.dumps({"frames": len(data), "pictures": pictures, "rates": rates}))
"""


def ours(path: Path, wanted: np.ndarray) -> tuple[int, list[float]]:
    """Frames of the dataset that have an action, and items per CPU-second: first, later."""
    rows = [(e, t) for e in rtphys.Dataset(path) for t in range(len(e) - 1)]
    rates = []
    for _ in range(2):
        start = time.process_time()
        for row in wanted % len(rows):
            episode, t = rows[row]
            _ = [episode.image(camera, t) for camera in CAMERAS], episode.state[t]
            _ = episode.action[t]
        rates.append(len(wanted) / (time.process_time() - start))
    return len(rows), rates


def theirs(python: Path, exported: Path, wanted: list[int]) -> dict:
    """What LeRobot's dataset does with these rows."""
    line = [python, "-c", LEROBOT, exported, json.dumps(wanted)]
    # Threads that wait for work would cost CPU time.
    single = {**os.environ, "OMP_NUM_THREADS": "1"}
    done = subprocess.run(line, check=True, capture_output=True, text=True, env=single)
    return json.loads(done.stdout.splitlines()[-1])


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("dataset", type=Path)
    parser.add_argument("--lerobot", type=Path, required=True, help="a Python that has lerobot")
    parser.add_argument("--items", type=int, default=1000)
    parser.add_argument("--lerobot-items", type=int, default=120)
    args = parser.parse_args()
    wanted = np.random.default_rng(0).integers(2**31, size=args.items)
    frames, (first, later) = ours(args.dataset, wanted)
    with tempfile.TemporaryDirectory() as folder:
        exported = Path(folder) / "exported"
        export = (Path(sys.executable).with_name("rtphys"), "export", "lerobot")
        subprocess.run([*export, args.dataset, "--out", exported], check=True)
        rows = (wanted[: args.lerobot_items] % frames).tolist()
        found = theirs(args.lerobot, exported, rows)
    if (found["frames"], found["pictures"]) != (frames, len(CAMERAS)):
        raise SystemExit(f"not the same frames: {frames} of {len(CAMERAS)} pictures, {found}")
    for name, (one, two), unit in (
        ("rtphys", (first, later), f" items per CPU-s ({len(wanted)})"),
        ("LeRobot", found["rates"], f" items per CPU-s ({len(rows)})"),
        ("ratio", (first / found["rates"][0], later / found["rates"][1]), ""),
    ):
        print(f"{name:8} {one:8.1f} first {two:8.1f} later{unit}")


if __name__ == "__main__":
    main()
