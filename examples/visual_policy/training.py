"""Train on datasets: python training.py DATASET ... --task click_bell --out weights/click_bell.pt

The same command continues after an interruption. Same data, options and machine: same weights to
the bit, because every step draws its batch from the seed and its own number.
"""

import argparse
import math
import time
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass
from pathlib import Path

import numpy as np
import torch
from demonstrations import CHUNK, Demonstrations, digest, load
from network import ARMS, GRIPPERS, Network, Shape
from pretrained import Eye
from sight import PICTURES, Sees, looks
from torch import Tensor

import rtphys

# Standard deviations [rad] of the noise on the command that is shown, smallest and largest; one is
# drawn for each sample. Targets stay, so the network learns to return to the demonstration.
NOISE = (0.003, 0.05)
OBJECTS_WEIGHT = 0.5  # of the objects' positions [0.1 m] in the loss
MEASURED = 7  # every so many frames suffice for the spread of features
REPORT, KEEP = 100, 500  # steps between reports, and between checkpoints


@dataclass(frozen=True)
class Options:
    """What decides the weights, apart from the data."""

    task: str
    steps: int = 2400
    batch: int = 64
    rate: float = 1e-3  # Adam's, at first; it falls to 0 along a cosine
    sees: Sees = "joints"  # beside pictures
    seed: int = 0


class Samples:
    """Demonstrations on a device; draws batches with noise."""

    def __init__(self, data: Demonstrations, options: Options, device: str) -> None:
        self._options, self._device = options, device
        self.seen = {
            camera: tuple(torch.from_numpy(array).to(device) for array in arrays)
            for camera, arrays in data.seen.items()
        }
        self.command = torch.from_numpy(data.command).to(device)
        self.following = torch.from_numpy(data.following).to(device)
        self.objects = torch.from_numpy(data.objects).to(device)
        self.felt = torch.from_numpy(data.felt).to(device)
        self._begin, self._looks = self._on(data.begin), self._on(looks(options.sees))

    def batch(self, step: int) -> dict[str, object]:
        """One batch, a function of the seed and the step alone."""
        rng = np.random.default_rng([self._options.seed, step])
        size = self._options.batch
        rows = self._on(rng.integers(len(self.command), size=size))
        spread = np.exp(rng.uniform(*np.log(NOISE), size=(size, 1)))
        noise = spread * rng.normal(size=(size, 14))
        noise[:, GRIPPERS] = 0
        return {
            "seen": {c: tuple(array[rows] for array in arrays) for c, arrays in self.seen.items()},
            "command": self.command[rows] + self._on(noise.astype(np.float32)),
            "felt": self.felt[torch.maximum(rows[:, None] - self._looks, self._begin[rows, None])],
            "following": self.following[rows],
            "objects": self.objects[rows],
        }

    def _on(self, array: np.ndarray) -> Tensor:
        return torch.from_numpy(array).to(self._device)


def errors(net: Network, batch: dict) -> tuple[Tensor, Tensor, Tensor]:
    """Mean absolute errors of arms [rad], openings, and object positions [m]."""
    actions, objects = net(batch["seen"], batch["command"], batch["felt"])
    off = (actions - batch["following"]).abs()
    return (
        off[..., ARMS].mean(),
        off[..., GRIPPERS].mean(),
        (objects - batch["objects"]).abs().mean(),
    )


def train(data: Demonstrations, options: Options, out: Path, device: str = "cpu") -> Network:
    """Train a network, or continue what `out` holds; write it to `out`.

    Raises:
        ValueError: what `out` holds was trained on other data or with other options.
    """
    torch.manual_seed(options.seed)
    torch.use_deterministic_algorithms(True)
    objects, felt = data.objects.shape[1], data.felt.shape[1]
    shape = Shape(CHUNK, objects, felt, len(looks(options.sees)))
    samples, net = Samples(data, options, device), Network(shape).to(device)
    for encoder, camera in ((net.head, "head"), (net.wrist, "left")):
        encoder.measure(*(array[::MEASURED].float() for array in samples.seen[camera]))
    net.measure("command", samples.command)
    net.measure("objects", samples.objects)
    net.measure("felt", samples.felt)
    adam = torch.optim.Adam(net.parameters(), lr=options.rate)
    about = {"options": asdict(options), "data": data.digest, "longest": data.longest}
    first = _continued(out, about, net, adam)
    running, started = None, time.monotonic()
    for step in range(first, options.steps):
        for group in adam.param_groups:
            group["lr"] = options.rate * 0.5 * (1 + math.cos(math.pi * step / options.steps))
        found = errors(net, samples.batch(step))
        adam.zero_grad()
        (found[0] + found[1] + 10 * OBJECTS_WEIGHT * found[2]).backward()
        torch.nn.utils.clip_grad_norm_(net.parameters(), 1.0)
        adam.step()
        now = torch.stack(found).detach()
        running = now if running is None else running + 0.02 * (now - running)
        done = step + 1
        if done % REPORT == 0 or done == options.steps:
            report(done, options, running.tolist(), (time.monotonic() - started) / (done - first))
        if done % KEEP == 0 or done == options.steps:
            save(out, about, net, adam, done)
    return net


def report(done: int, options: Options, error: Sequence[float], step_s: float) -> None:
    """Print one line about the progress."""
    arms, grips, objects = error
    left = round(step_s * (options.steps - done))
    print(
        f"{options.task} step {done}/{options.steps}: arms {1000 * arms:.1f} mrad, openings "
        f"{grips:.3f}, objects {1000 * objects:.1f} mm, {options.batch / step_s:.0f} samples/s, "
        f"{left // 60}:{left % 60:02d} left",
        flush=True,
    )


def save(
    out: Path, about: dict[str, object], net: Network, adam: torch.optim.Adam, done: int
) -> None:
    """Write a checkpoint; a kill leaves the one before."""
    out.parent.mkdir(parents=True, exist_ok=True)
    new = out.with_suffix(".new")
    found = {"net": net.state_dict(), "adam": adam.state_dict(), "shape": net.shape.to_json()}
    torch.save({**about, **found, "done": done, "rtphys": rtphys.__version__}, new)
    new.replace(out)


def _continued(out: Path, about: dict[str, object], net: Network, adam: torch.optim.Adam) -> int:
    if (found := checkpoint(out, about)) is None:
        return 0
    net.load_state_dict(found["net"])
    adam.load_state_dict(found["adam"])
    return int(found["done"])


def checkpoint(out: Path, about: Mapping[str, object]) -> dict | None:
    """What `out` holds, if anything.

    Raises:
        ValueError: it was trained on other data or with other options than `about` says.
    """
    if not out.exists():
        return None
    found = torch.load(out, map_location="cpu", weights_only=True)
    for key in ("options", "data"):
        if found[key] != about[key]:
            raise ValueError(f"{out}: trained with {key} {found[key]}, not {about[key]}; remove it")
    return found


def main() -> None:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("datasets", type=Path, nargs="+", metavar="DATASET")
    parser.add_argument("--task", required=True)
    parser.add_argument("--protocol", help="of the episodes; default: all of the task's")
    parser.add_argument("--out", type=Path, required=True)
    parser.add_argument("--episodes", type=int, help="so many of each dataset; default: all")
    parser.add_argument("--steps", type=int, default=Options.steps)
    parser.add_argument("--batch", type=int, default=Options.batch)
    parser.add_argument("--rate", type=float, default=Options.rate)
    parser.add_argument(
        "--sees",
        choices=("joints", "touch", "memory"),
        default=Options.sees,
        help="beside pictures: joint commands; also efforts and touch; also those of the last 15 s",
    )
    parser.add_argument("--seed", type=int, default=Options.seed)
    parser.add_argument("--device", default="cpu", help="cuda, cuda:1, ...")
    parser.add_argument("--threads", type=int, default=1, help="of PyTorch, on a CPU")
    args = parser.parse_args()
    torch.set_num_threads(args.threads)
    decisive = ("task", "steps", "batch", "rate", "sees", "seed")
    options = Options(**{name: getattr(args, name) for name in decisive})
    opened = [rtphys.Dataset(path).where(args.task, args.protocol) for path in args.datasets]
    episodes = [episode for dataset in opened for episode in dataset[: args.episodes]]
    # Known from the files: reading their pictures takes minutes.
    found = checkpoint(args.out, {"options": asdict(options), "data": digest(episodes)})
    if found is not None and found["done"] == options.steps:
        print(f"{args.out}: {options.steps} steps done")
        return
    data = load(episodes, Eye(args.device), feeling=options.sees != "joints")
    sizes = ", ".join(f"{camera} {w}x{h}" for camera, (h, w) in PICTURES.items())
    print(f"{len(data)} frames of {len(episodes)} demonstrations, {sizes}")
    train(data, options, args.out, args.device)


if __name__ == "__main__":
    main()
