"""The only source of chance: one named stream per purpose, derived from the episode seed."""

import hashlib

import numpy as np


def stream(seed: int, *name: str) -> np.random.Generator:
    """An independent generator for (episode seed, name).

    Streams share nothing, so a new consumer moves no older draw: `stream(7, "friction")` is
    the same whatever else the episode draws, in any process, on any platform.

    Args:
        seed: episode seed, any non-negative integer.
        name: path of the consumer, such as `("layout", "block0")`.

    Returns:
        A PCG64 generator seeded with SHA-256 of seed and name.
    """
    if seed < 0:
        raise ValueError(f"an episode seed is never negative, got {seed}")
    digest = hashlib.sha256("\x1f".join([str(int(seed)), *name]).encode()).digest()
    return np.random.Generator(np.random.PCG64(int.from_bytes(digest[:16], "little")))
