"""Trains a network on demonstrations: python train.py DATASET --task click_bell --out bell.npz"""

import argparse
from pathlib import Path

import numpy as np
from features import CHUNK, features
from mlp import Adam, Mlp
from numpy.typing import NDArray

from rtphys.data.dataset import Dataset, Episode

HIDDEN = (256, 256, 256)
STEPS, BATCH = 6000, 512
# Standard deviations [rad] of the noise on an input command, smallest and largest; one is drawn per
# example. Targets stay, so that the network learns to return to the demonstration.
NOISE = (0.003, 0.05)
AFTER = 3  # frames kept after the first success; later frames retrace the same postures


Numbers = NDArray[np.float64]


def examples(episode: Episode) -> tuple[Numbers, dict[str, Numbers], Numbers]:
    """Training examples: commands (n, 14), object poses (n, 7), next commands (n, CHUNK, 14)."""
    reached = episode.meta.verdict.first_success_time
    times = episode.frames.time
    end = len(episode) if reached is None else int(np.searchsorted(times, reached)) + AFTER
    end = min(max(end, 2), len(episode))
    command = episode.state[:end]
    following = np.minimum(np.arange(end)[:, None] + np.arange(1, CHUNK + 1), end - 1)
    # Clutter differs from episode to episode, and the policy is not shown it.
    names = [name for name in episode.frames.object_poses if not name.startswith("clutter")]
    poses = {name: episode.poses(name)[:end] for name in names}
    return command, poses, command[following]


def train(dataset: Dataset, seed: int = 0) -> Mlp:
    """Train one network on the episodes of one task."""
    rng = np.random.default_rng(seed)
    commands, objects, targets = zip(*map(examples, dataset), strict=True)
    command, following = np.concatenate(commands), np.concatenate(targets)
    poses = {name: np.concatenate([part[name] for part in objects]) for name in objects[0]}
    net = Mlp([features(command, poses).shape[1], *HIDDEN, CHUNK * 14], rng)
    net.normalise(features(command, poses))
    adam = Adam([*net.weights, *net.biases], STEPS)
    error = 0.0
    for step in range(1, STEPS + 1):
        rows = rng.integers(len(command), size=BATCH)
        spread = np.exp(rng.uniform(*np.log(NOISE), size=(BATCH, 1)))
        noisy = command[rows] + spread * rng.normal(size=(BATCH, 14))
        x = features(noisy, {name: pose[rows] for name, pose in poses.items()})
        target = (following[rows] - noisy[:, None]).reshape(BATCH, -1).astype(np.float32)
        step_error, gradients = net.gradients(x, target)
        adam.update(gradients)
        error += 0.01 * (step_error - error)  # running mean
        if step % 1000 == 0:
            print(f"step {step}: {np.sqrt(error):.4f} rad")
    return net


def main() -> None:
    """Train on the episodes of one task and write the weights."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("dataset", type=Path)
    parser.add_argument("--task", required=True)
    parser.add_argument("--out", type=Path, required=True)
    args = parser.parse_args()
    dataset = Dataset(args.dataset).where(task=args.task)
    print(f"{len(dataset)} demonstrations of {args.task}")
    train(dataset).save(args.out)


if __name__ == "__main__":
    main()
