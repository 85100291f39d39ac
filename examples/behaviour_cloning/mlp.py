"""Multilayer perceptron and Adam optimiser in NumPy, small enough to read."""

from collections.abc import Sequence
from itertools import pairwise
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float32]

RATE, BETA_1, BETA_2, TINY = 2e-3, 0.9, 0.999, 1e-8  # Adam's defaults, with twice the rate


class Mlp:
    """Multilayer perceptron with tanh activations that scales its inputs.

    Args:
        sizes: of the input, the hidden layers and the output.
        rng: draws the initial weights.
    """

    def __init__(self, sizes: Sequence[int], rng: np.random.Generator) -> None:
        pairs = list(pairwise(sizes))
        self.weights: list[Array] = [
            (rng.normal(size=pair) / np.sqrt(pair[0])).astype(np.float32) for pair in pairs
        ]
        self.biases: list[Array] = [np.zeros(n, np.float32) for _, n in pairs]
        self.mean, self.scale = np.zeros(sizes[0], np.float32), np.ones(sizes[0], np.float32)

    def normalise(self, inputs: Array) -> None:
        """Scale inputs like these (n, inputs) to mean 0 and deviation 1; constant ones become 0."""
        self.mean, spread = inputs.mean(0), inputs.std(0)
        self.scale = np.where(spread > 1e-4, 1 / np.maximum(spread, 1e-4), 0).astype(np.float32)

    def __call__(self, x: Array) -> Array:
        """Outputs (n, outputs) for inputs (n, inputs)."""
        return self._layers(x)[-1]

    def _layers(self, x: Array) -> list[Array]:
        """Scaled inputs and the outputs of every layer."""
        layers = [(x - self.mean) * self.scale]
        for i, (w, b) in enumerate(zip(self.weights, self.biases, strict=True)):
            z = layers[-1] @ w + b
            layers.append(z if i == len(self.weights) - 1 else np.tanh(z))
        return layers

    def gradients(self, x: Array, target: Array) -> tuple[float, list[Array]]:
        """Mean squared error, and its gradients by all weights, then by all biases."""
        layers = self._layers(x)
        residual = layers[-1] - target
        error: Array = (residual * (2 / residual.size)).astype(residual.dtype)
        by_weight: list[Array] = []
        by_bias: list[Array] = []
        for i in reversed(range(len(self.weights))):
            by_weight.insert(0, layers[i].T @ error)
            by_bias.insert(0, error.sum(0, dtype=error.dtype))
            if i:
                error = (error @ self.weights[i].T) * (1 - layers[i] ** 2)
        return float((residual**2).mean()), [*by_weight, *by_bias]

    def save(self, path: Path) -> None:
        """Write weights and scaling as .npz."""
        arrays = {f"w{i}": w for i, w in enumerate(self.weights)}
        arrays |= {f"b{i}": b for i, b in enumerate(self.biases)}
        np.savez(path, allow_pickle=False, mean=self.mean, scale=self.scale, **arrays)

    @staticmethod
    def load(path: Path) -> "Mlp":
        """Inverse of `save`."""
        with np.load(path) as arrays:
            count = sum(name.startswith("w") for name in arrays.files)
            sizes = [arrays["w0"].shape[0], *(arrays[f"w{i}"].shape[1] for i in range(count))]
            net = Mlp(sizes, np.random.default_rng(0))
            net.weights = [arrays[f"w{i}"] for i in range(count)]
            net.biases = [arrays[f"b{i}"] for i in range(count)]
            net.mean, net.scale = arrays["mean"], arrays["scale"]
        return net


class Adam:
    """Adam optimiser (Kingma and Ba 2015) that updates parameters in place.

    The learning rate falls to 0 along a cosine over `steps` updates.
    """

    def __init__(self, parameters: list[Array], steps: int) -> None:
        self._parameters, self._steps, self._step = parameters, steps, 0
        self._first = [np.zeros_like(p) for p in parameters]
        self._second = [np.zeros_like(p) for p in parameters]

    def update(self, gradients: list[Array]) -> None:
        """Apply one step; gradients are in the order of the parameters."""
        self._step += 1
        rate = RATE * 0.5 * (1 + np.cos(np.pi * self._step / self._steps))
        rate *= np.sqrt(1 - BETA_2**self._step) / (1 - BETA_1**self._step)
        for p, g, m, v in zip(self._parameters, gradients, self._first, self._second, strict=True):
            m += (1 - BETA_1) * (g - m)
            v += (1 - BETA_2) * (g * g - v)
            p -= (rate * m / (np.sqrt(v) + TINY)).astype(np.float32)
