"""The stored JPEG streams of one camera, taken out one at a time."""

from collections.abc import Iterator
from dataclasses import dataclass

import h5py
import numpy as np
from numpy.typing import NDArray

from rtphys.data.hdf5_file import array

BEGIN, END = b"\xff\xd8", b"\xff\xd9"


@dataclass(frozen=True, eq=False)
class Streams:
    """T pictures as a file holds them. Lists of `bytes` would hold every picture a second time."""

    rows: NDArray[np.bytes_]  # (T,) or, with a `last` one, (T - 1,)
    last: bytes | None  # the picture that the shifted layout keeps apart
    shape: tuple[int, int, int]  # of a decoded one (H, W, 3)

    def __len__(self) -> int:
        return len(self.rows) + (self.last is not None)

    def __getitem__(self, index: int) -> bytes:
        """Stream 0 .. T-1; numpy strips the NUL padding."""
        if self.last is not None and index == len(self.rows):
            return self.last
        return self.rows.item(index)

    def __iter__(self) -> Iterator[bytes]:
        return (self[index] for index in range(len(self)))

    def whole(self) -> list[bool]:
        """For each picture: whether it begins and ends as a JPEG stream does."""
        last = [] if self.last is None else [_whole(self.last)]
        if self.rows.dtype.kind != "S" or self.rows.itemsize < len(BEGIN + END):
            return [_whole(stream) for stream in self.rows.tolist()] + last
        # By columns: taking every stream out would copy the file once more.
        lengths = np.char.str_len(self.rows)
        table = self.rows.view(np.uint8).reshape(len(self.rows), -1)
        tail = lengths[:, None] - np.arange(len(END), 0, -1)
        tails = np.take_along_axis(table, np.maximum(tail, 0), axis=1)
        whole = (table[:, : len(BEGIN)] == [*BEGIN]).all(axis=1) & (tails == [*END]).all(axis=1)
        return (whole & (lengths >= len(BEGIN + END))).tolist() + last


def _whole(stream: bytes) -> bool:
    return stream.startswith(BEGIN) and stream.endswith(END)


def stream_rows(node: h5py.Group, key: str) -> NDArray[np.bytes_]:
    """The rows of a dataset of streams. Raises `KeyError`, or `ValueError` for another kind."""
    rows = array(node, key)
    if rows.ndim != 1 or rows.dtype.kind != "S":
        raise ValueError(f"{key} holds {rows.dtype} {rows.shape}, no picture streams")
    return rows
