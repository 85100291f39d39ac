"""What a GPU draws, against the bars of docs/scale.md: made for a machine that is lent for minutes.

    python benchmarks/gpu.py [--episodes 10] [--group 16] [--baseline]     about six minutes

Pixels: episodes of many tasks drawn together, and one by one on the same card. Drawing: pictures a
second of one process, so and so, and by SAPIEN's own groups with poses from CUDA, if torch is there
(they are no path of rtphys: their matrices are computed on the card, and lights do not change).
End to end: `collect` of so many episodes of each task of training_v1; `--baseline`: also with
workers that do all. Exit code 1 if a bar is missed. On a machine without a GPU it is a dry run.
"""

import argparse
import sys
import tempfile
import time
from collections.abc import Callable, Sequence
from dataclasses import replace
from pathlib import Path

import rtphys  # noqa: F401  # isort: skip  (before numpy: it chooses the arithmetic)

import numpy as np
import sapien
from scale import rates

from rtphys.assets.pack import default_pack
from rtphys.core import library
from rtphys.doctor import check_renderer
from rtphys.episode.generate import attempt
from rtphys.episode.render import Pictures, StateTrajectory, draw_together, render_frames
from rtphys.sim import renderer
from rtphys.sim.engine import unpacked
from rtphys.spec.episode import EpisodeSpec
from rtphys.spec.recording import RecordingSpec
from rtphys.studies.requests import Run, find_collection, read_specs
from rtphys.task.spec import load_task

PICTURES, MINUTES = 3000, 15  # a second; for 5,000 episodes
ROWS = 40  # drawn of each episode

Begin = Callable[[], list[Pictures]]


def episodes(count: int, protocol: str, senses: tuple[str, ...] = ()) -> tuple[Begin, list[bytes]]:
    """Scenes of so many tasks, built anew with each call; the first one's states."""
    names, pack = sorted(library.names("tasks"))[:count], default_pack()
    tried = [attempt(EpisodeSpec(name, protocol).at(0), load_task(name), pack) for name in names]
    states = [StateTrajectory.of(one.recording) for one in tried if one.recording is not None]
    rows = [replace(one, times=one.times[:ROWS], packed=one.packed[:ROWS]) for one in states]
    recording = RecordingSpec(senses=senses)

    def begin() -> list[Pictures]:
        pairs = zip([one for one in tried if one.recording is not None], rows, strict=True)
        return [
            render_frames(one.recipe, load_task(one.recipe.task), pack, row, recording).images
            for one, row in pairs
        ]

    return begin, [packed for row in rows for packed in row.packed]


def differences(group: int, senses: tuple[str, ...]) -> int:
    """Pixels that differ between episodes drawn together and alone; flickering lights included."""
    begin, _ = episodes(group, "phys_random_all", senses)
    alone = [list(pictures) for pictures in begin()]
    together = draw_together(begin(), [list] * len(alone))
    return sum(
        int((one[name] != other[name]).any(axis=-1).sum())
        for ones, others in zip(alone, together, strict=True)
        for one, other in zip(ones, others, strict=True)
        for name in one
    )


def speeds(group: int) -> tuple[float, float, str]:
    """Pictures a second of this process: one by one, together, by SAPIEN's groups; nothing else."""
    begin, states = episodes(group, "clean")
    alone, together = begin(), begin()
    count = 3 * len(states)
    start = time.perf_counter()
    for pictures in alone:
        for _ in pictures:
            pass
    middle = time.perf_counter()
    draw_together(together, [lambda images: sum(1 for _ in images)] * len(together))
    end = time.perf_counter()
    try:
        own = by_sapien(begin())
    except Exception as error:
        own = f"not to be had: {type(error).__name__}: {error}"
    return count / (middle - start), count / (end - middle), own


def by_sapien(group: Sequence[Pictures]) -> str:
    """Pictures a second by `RenderSystemGroup`, and how many pixels of a row differ."""
    import torch

    scenes, rows, systems = [one.scene for one in group], list[np.ndarray](), []
    for one in scenes:
        scene, first = one.world.scene, sum(map(len, rows))
        rows.append(unpacked(scene.pack_poses()))
        systems.append(scene.render_system)
        for row, entity in enumerate(scene.entities, start=first):
            for part in entity.components:
                if isinstance(part, sapien.render.RenderBodyComponent):
                    for shape in part.render_shapes:
                        shape.set_gpu_pose_batch_index(row)
                elif isinstance(part, sapien.render.RenderCameraComponent):
                    part.set_gpu_pose_batch_index(row)
        scene.update_render()
    expected = [one.frames() for one in scenes]
    buffer = torch.zeros((sum(map(len, rows)), 13), dtype=torch.float32, device="cuda")
    buffer[:, :7] = torch.from_numpy(np.concatenate(rows)).cuda()
    whole = sapien.render.RenderSystemGroup(systems)
    whole.set_cuda_poses(sapien.CudaArray(buffer))
    cameras = {
        camera.spec.name: whole.create_camera_group(
            [one.cameras[n].component for one in scenes], ["Color"]
        )
        for n, camera in enumerate(scenes[0].cameras)
    }
    start, seen = time.perf_counter(), dict[str, np.ndarray]()
    for _ in range(ROWS):
        torch.cuda.synchronize()
        whole.update_render()
        for name, each in cameras.items():
            each.take_picture()
            seen[name] = each.get_picture_cuda("Color").torch().cpu().numpy()
    rate = ROWS * len(scenes) * len(cameras) / (time.perf_counter() - start)
    wrong = sum(
        int((seen[name][n][..., :3] != frame.rgb).any(axis=-1).sum())
        for n, frames in enumerate(expected)
        for name, frame in frames.items()
    )
    return f"{rate:.0f}/s, {wrong} pixels of a row of {len(scenes)} scenes differ"


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
    parser.add_argument("--baseline", action="store_true", help="also without drawing workers")
    asked = parser.parse_args()
    finding = check_renderer()
    print(f"{finding.status}: {finding.detail}", flush=True)
    dry, bars = not finding.gpus, dict[str, bool]()
    renderer.configure()
    for senses in ((), ("depth", "segmentation")):
        wrong = differences(asked.group, senses)
        bars[f"pixels equal{', with senses' * bool(senses)}"] = not wrong
        print(f"pixels that differ, senses {senses or 'none'}: {wrong}", flush=True)
    alone, together, own = speeds(asked.group)
    print(f"one by one {alone:.0f}/s, {asked.group} together {together:.0f}/s", flush=True)
    print(f"SAPIEN's groups: {own}", flush=True)
    for gpus in (0, None) if asked.baseline else (1 if dry else None,):
        pictures, minutes = collected(asked.episodes, gpus, dry)
        print(f"end to end, gpus {gpus}: {pictures:.0f}/s, 5,000 episodes in {minutes:.1f} min")
    bars[f"{PICTURES} pictures a second"] = pictures >= PICTURES
    bars[f"5,000 episodes in {MINUTES} min"] = minutes <= MINUTES
    for bar, kept in bars.items():
        print(f"{'pass' if kept else 'FAIL'}: {bar}")
    sys.exit(0 if all(bars.values()) else 1)


if __name__ == "__main__":
    main()
