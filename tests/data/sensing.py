"""Synthetic senses, a function of the seed, for tests of several files."""

import numpy as np
import synthetic

from rtphys.data.sensed import BodyPoses, Sensed

SENSES = ("depth", "segmentation", "pointcloud", "states")
NAMES = ("background", "table", "bell", "left_camera")


def sensed(seed: int, frames: int = 8, senses: tuple[str, ...] = SENSES) -> Sensed:
    rng = np.random.default_rng(seed)
    shape = (synthetic.HEIGHT, synthetic.WIDTH)
    made = Sensed(senses)
    for name in synthetic.CAMERAS:
        if "depth" in senses:
            made.depth[name] = [rng.random(shape, np.float32) * 2 for _ in range(frames)]
        if "segmentation" in senses:
            ids = [rng.integers(0, len(NAMES), shape).astype(np.uint8) for _ in range(frames)]
            made.actors[name], made.meshes[name] = ids, ids[::-1]
            made.names = {"actor": NAMES, "mesh": NAMES}
    if "pointcloud" in senses:
        made.clouds = [rng.random((1024, 6), np.float32) for _ in range(frames)]
    if "states" in senses:
        poses = rng.random((frames, 3, 7), np.float32)
        poses[..., 3:] /= np.linalg.norm(poses[..., 3:], axis=-1, keepdims=True)
        made.bodies = BodyPoses(("ground", "table", "bell"), poses)
    return made
