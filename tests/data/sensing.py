"""Synthetic senses, a function of the seed, for tests of several files."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import synthetic
from collected import write

from rtphys.data.dataset import Dataset
from rtphys.data.episode import Sensed
from rtphys.senses.depth import DEPTH_SCALE
from rtphys.senses.touch import TouchSense

SENSES = ("depth", "segmentation", "pointcloud", "states")
NAMES = ("background", "table", "bell", "left_camera")


def sensed(seed: int, frames: int = 8, senses: tuple[str, ...] = SENSES) -> Sensed:
    rng = np.random.default_rng(seed)
    shape = (synthetic.HEIGHT, synthetic.WIDTH)
    made = Sensed(senses)
    for name in synthetic.CAMERAS:
        if "depth" in senses:
            steps = rng.integers(0, 2 * DEPTH_SCALE, (frames, *shape)).astype(np.float32)
            made.tracks["depth", name] = [*(steps / np.float32(DEPTH_SCALE))]
        if "segmentation" in senses:
            ids = [rng.integers(0, len(NAMES), shape).astype(np.uint8) for _ in range(frames)]
            made.tracks["actors", name], made.tracks["meshes", name] = ids, ids[::-1]
            made.names |= {"actor": NAMES, "mesh": NAMES}
    if "pointcloud" in senses:
        made.tracks["cloud", ""] = [rng.random((1024, 6), np.float32) for _ in range(frames)]
    if "states" in senses:
        poses = rng.random((frames, 3, 7), np.float32)
        poses[..., 3:] /= np.linalg.norm(poses[..., 3:], axis=-1, keepdims=True)
        made.tracks["bodies", ""], made.names["body"] = poses, ("ground", "table", "bell")
    if "touch" in senses:
        fingers, more = ("fl7", "fl8", "fr7", "fr8"), {"force": (3,), "pressed": (1,)}
        for one in TouchSense.fields:
            shape = (frames, len(fingers), *more.get(one.name, ()))
            made.tracks[one.name, ""] = rng.random(shape, np.float32)
        made.names |= {"finger": fingers, "object": ("bell",)}
    return made


def collect(
    out: Path, episodes: int, frames: int, senses: tuple[str, ...] = SENSES, layout: str = "native"
) -> Dataset:
    """Episodes of so many frames with these senses."""
    made = [
        replace(synthetic.episode(seed, frames), sensed=sensed(seed, frames, senses))
        for seed in range(episodes)
    ]
    return write(out, *made, what=synthetic.header(layout, senses=senses))
