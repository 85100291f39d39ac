"""What a GPU draws, against the bars of docs/scale.md: made for a machine that is lent for minutes.

    python benchmarks/gpu.py [--episodes 10] [--group 16] [--baseline 0]     about three minutes

Pixels: episodes of many tasks drawn together, and one by one on the same card. Drawing: pictures a
second of one process, so and so. End to end: `collect` of so many episodes of each task of
training_v1; `--baseline N`: also with workers that do all. Exit code 1 if a bar is missed. On a
machine without a GPU it is a dry run.
"""

import argparse
import sys
import tempfile
import time
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import rtphys.core.pinned  # noqa: F401  # isort: skip  (before numpy)

from scale import rates

from rtphys.assets.pack import default_pack
from rtphys.core import library
from rtphys.data.episode import Images
from rtphys.doctor import check_renderer
from rtphys.episode.generate import attempt
from rtphys.episode.render import Pictures, StateTrajectory, draw_together, render_frames
from rtphys.sim import camera_group, renderer
from rtphys.spec.episode import EpisodeSpec
from rtphys.spec.recording import RecordingSpec
from rtphys.studies.requests import Run, find_collection, read_specs
from rtphys.task.spec import load_task

PICTURES, MINUTES = 3000, 15  # a second; for 5,000 episodes
ROWS = 40  # drawn of each episode


class Scenes:
    """Episodes of so many tasks, under `phys_random_all`; flickering lights may be among them."""

    def __init__(self, count: int) -> None:
        self._pack, names = default_pack(), sorted(library.names("tasks"))[:count]
        recipes = [EpisodeSpec(name, "phys_random_all").at(0) for name in names]
        tried = [attempt(one, load_task(one.task), self._pack) for one in recipes]
        self._recipes = [one.recipe for one in tried if one.recording is not None]
        whole = [StateTrajectory.of(one.recording) for one in tried if one.recording is not None]
        self._rows = [
            replace(one, times=one.times[:ROWS], packed=one.packed[:ROWS]) for one in whole
        ]
        self.pictures = 3 * sum(len(row.times) for row in self._rows)

    def begin(self, senses: tuple[str, ...] = ()) -> list[Pictures]:
        """Builds them anew."""
        spec = RecordingSpec(senses=senses)
        pairs = zip(self._recipes, self._rows, strict=True)
        return [
            render_frames(one, load_task(one.task), self._pack, row, spec).images
            for one, row in pairs
        ]


def differences(scenes: Scenes, senses: tuple[str, ...]) -> int:
    """Pixels that differ between episodes drawn together and one by one."""
    alone = [list(one_by_one(pictures)) for pictures in scenes.begin(senses)]
    together = draw_together(scenes.begin(senses), [list] * len(alone))
    return sum(
        int((one[name] != other[name]).any(axis=-1).sum())
        for ones, others in zip(alone, together, strict=True)
        for one, other in zip(ones, others, strict=True)
        for name in one
    )


def one_by_one(pictures: Pictures) -> Iterator[Images]:
    """As a CPU draws them."""
    while pictures.show():
        yield pictures.get()


def speeds(scenes: Scenes) -> tuple[float, float]:
    """Pictures a second of this process, one by one and together; nothing else."""
    alone, together = scenes.begin(), scenes.begin()
    start = time.perf_counter()
    for pictures in alone:
        for _ in one_by_one(pictures):
            pass
    middle = time.perf_counter()
    draw_together(together, [lambda images: sum(1 for _ in images)] * len(together))
    end = time.perf_counter()
    return scenes.pictures / (middle - start), scenes.pictures / (end - middle)


def collected(count: int, gpus: int | None, dry: bool) -> tuple[float, float]:
    """Pictures a second, and minutes for 5,000 episodes of training_v1, from a part of it."""
    specs = read_specs(find_collection("training_v1"))[: 2 if dry else None]
    specs = [replace(spec, episodes=count) for spec in specs]
    with tempfile.TemporaryDirectory(prefix="rtphys-gpu-") as folder:
        made = rates(specs, Run(Path(folder) / "data", gpus=gpus), whole=True)
    return made.pictures, 5000 / made.episodes


def main() -> None:
    """Prints a line for each measurement."""
    parser = argparse.ArgumentParser()
    parser.add_argument("--episodes", type=int, default=10, help="of each task, end to end")
    parser.add_argument("--group", type=int, default=16, help="episodes that are drawn together")
    parser.add_argument(
        "--baseline", type=int, default=0, help="of each task, without drawing workers"
    )
    asked = parser.parse_args()
    finding = check_renderer()
    print(f"{finding.status}: {finding.detail}", flush=True)
    dry, bars = not finding.gpus, dict[str, bool]()
    renderer.configure()
    print(f"pictures in groups: {camera_group.obstacle() or 'yes'}", flush=True)
    scenes = Scenes(asked.group)
    for senses in ((), ("depth", "segmentation")):
        wrong = differences(scenes, senses)
        bars[f"pixels equal{', with senses' * bool(senses)}"] = not wrong
        print(f"pixels that differ, senses {senses or 'none'}: {wrong}", flush=True)
    alone, together = speeds(scenes)
    print(f"one by one {alone:.0f}/s, {asked.group} together {together:.0f}/s", flush=True)
    pictures, minutes = collected(asked.episodes, 1 if dry else None, dry)
    bars[f"{PICTURES} pictures a second"] = pictures >= PICTURES
    bars[f"5,000 episodes in {MINUTES} min"] = minutes <= MINUTES
    said = "pictures/s, 5,000 episodes in"
    print(f"end to end: {pictures:.0f} {said} {minutes:.1f} min", flush=True)
    if asked.baseline:
        pictures, minutes = collected(asked.baseline, 0, dry)
        print(f"without drawing workers: {pictures:.0f} {said} {minutes:.1f} min")
    for bar, kept in bars.items():
        print(f"{'pass' if kept else 'FAIL'}: {bar}")
    sys.exit(0 if all(bars.values()) else 1)


if __name__ == "__main__":
    main()
