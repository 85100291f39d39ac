"""CPU-milliseconds of a saved 320x240 picture, all in: draw, encode, write, re-read, check.

`benchmarks/episode.py [EPISODES] [TASK...]`: real episodes with three cameras, video included.
"""

import sys
import tempfile
import time
from pathlib import Path

import numpy as np
from lib.tables import write

from rtphys.assemble import assemble
from rtphys.assets.pack import default_pack
from rtphys.data.staging import stage_episode
from rtphys.generate import attempt
from rtphys.photograph import photograph
from rtphys.recipe import Recipe
from rtphys.sim import renderer
from rtphys.task.spec import load_task, task_names

CAMERAS = ("head", "left", "right")
MOST_SEEDS = 20


def episode(name: str, seed: int, folder: Path) -> dict[str, float] | None:
    """Costs of one accepted attempt; None if it is rejected."""
    task, pack, recipe = load_task(name), default_pack(), Recipe(name, seed, "phys_random")
    tried = attempt(recipe, task, pack)
    if not tried.accepted or tried.recording is None:
        return None
    began = time.process_time()
    pictures = photograph(recipe, task, pack, tried.recording, CAMERAS)
    posed = time.process_time()
    staged = stage_episode(folder, assemble(tried, pictures, pack))
    done = time.process_time()
    count = staged.frames * len(CAMERAS)
    size = sum(facts.size for facts in staged.files.values())
    return {
        "build, pose": 1e3 * (posed - began) / count,
        "draw, encode, write": 1e3 * (done - posed) / count,
        "sum": 1e3 * (done - began) / count,
        "pictures": count,
        "kB a picture": size / count / 1e3,
    }


def main(episodes: int = 2, *names: str) -> None:
    renderer.configure()
    renderer.hold_anchor()
    rows: dict[str, dict[str, float]] = {}
    with tempfile.TemporaryDirectory() as scratch:
        for name in names or task_names():
            found: list[dict[str, float]] = []
            for seed in range(MOST_SEEDS):
                if len(found) < episodes and (costs := episode(name, seed, Path(scratch) / "e")):
                    found.append(costs)
            if found:
                rows[name] = {key: float(np.mean([c[key] for c in found])) for key in found[0]}
    rows["mean"] = {
        key: float(np.mean([row[key] for row in rows.values()]))
        for key in next(iter(rows.values()))
    }
    write("episode", f"CPU-milliseconds a saved picture, {episodes} episodes a task", rows)


if __name__ == "__main__":
    main(*map(int, sys.argv[1:2]), *sys.argv[2:])
