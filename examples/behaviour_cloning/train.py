"""Clones demonstrations from states: python train.py DATASET --task click_bell --out bell.npz"""

import argparse
from pathlib import Path

import numpy as np
from features import CHUNK, features
from mlp import Adam, Mlp
from numpy.typing import NDArray

from rtphys.data.dataset import Dataset, Episode

HIDDEN = (256, 256, 256)
STEPS, BATCH = 6000, 512
NOISE = (0.003, 0.05)  # [rad] of the command that is shown, a deviation drawn for every example:
# the answer leads back to the demonstration, from near and from far
AFTER = 3  # frames kept after the first success; what follows retraces the same postures


Numbers = NDArray[np.float64]


def examples(episode: Episode) -> tuple[Numbers, dict[str, Numbers], Numbers]:
    """Commands (n, 14), object poses (n, 7) by name, and the CHUNK commands that follow each."""
    reached = episode.meta.verdict.first_success_time
    times = episode.frames.time
    end = len(episode) if reached is None else int(np.searchsorted(times, reached)) + AFTER
    end = min(max(end, 2), len(episode))
    command = episode.state[:end]
    following = np.minimum(np.arange(end)[:, None] + np.arange(1, CHUNK + 1), end - 1)
    poses = {name: episode.poses(name)[:end] for name in episode.frames.object_poses}
    return command, poses, command[following]


def train(dataset: Dataset, seed: int = 0) -> Mlp:
    """One network for the episodes of one task."""
    rng = np.random.default_rng(seed)
    found = [examples(episode) for episode in dataset]
    command = np.concatenate([one[0] for one in found])
    poses = {name: np.concatenate([one[1][name] for one in found]) for name in found[0][1]}
    following = np.concatenate([one[2] for one in found])
    net = Mlp([features(command, poses).shape[1], *HIDDEN, CHUNK * 14], rng)
    net.normalise(features(command, poses))
    adam = Adam([*net.weights, *net.biases], STEPS)
    error = 0.0
    for step in range(1, STEPS + 1):
        rows = rng.integers(len(command), size=BATCH)
        spread = np.exp(rng.uniform(*np.log(NOISE), size=(BATCH, 1)))
        shown = command[rows] + spread * rng.normal(size=(BATCH, 14))
        x = features(shown, {name: pose[rows] for name, pose in poses.items()})
        wanted = (following[rows] - shown[:, None]).reshape(BATCH, -1).astype(np.float32)
        now, gradients = net.gradients(x, wanted)
        adam.update(gradients)
        error += 0.01 * (now - error)
        if step % 1000 == 0:
            print(f"step {step}: {np.sqrt(error):.4f} rad")
    return net


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("dataset", type=Path)
    parser.add_argument("--task", required=True)
    parser.add_argument("--out", type=Path, required=True)
    given = parser.parse_args()
    dataset = Dataset(given.dataset).where(task=given.task)
    print(f"{len(dataset)} demonstrations of {given.task}")
    train(dataset).save(given.out)


if __name__ == "__main__":
    main()
