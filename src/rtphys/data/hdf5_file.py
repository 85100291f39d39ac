"""HDF5 files made in memory, the same bytes for the same content, and a digest of the content."""

import hashlib
import io
from collections.abc import Callable, Mapping
from functools import lru_cache
from pathlib import Path

import h5py
import numpy as np

from rtphys.core.errors import BadFile

TEXT = h5py.string_dtype("utf-8")


def build(fill: Callable[[h5py.File], None]) -> bytes:
    """The bytes of an HDF5 file that `fill` writes into.

    In memory, so that a full disk is an ordinary failed write of bytes and never a half-written
    HDF5 file; with a fixed format version and without time stamps, so that bytes repeat.
    """
    with h5py.File.in_memory(libver=("v110", "v110"), track_order=False) as file:
        fill(file)
        file.flush()
        return file.id.get_file_image()


def put(group: h5py.Group, key: str, value: object, notes: Mapping[str, str] | None = None) -> None:
    """One contiguous dataset with text attributes; intermediate groups appear as needed."""
    data = np.asarray(value)
    if data.dtype.kind == "U":
        dataset = group.create_dataset(key, data=value, dtype=TEXT, track_times=False)
    else:
        dataset = group.create_dataset(key, data=data, track_times=False)
    for name, text in (notes or {}).items():
        dataset.attrs[name] = text


def open_read(source: Path | bytes) -> h5py.File:
    """Opens a file or its bytes. Raises `BadFile` when it is not HDF5."""
    try:
        return h5py.File(io.BytesIO(source) if isinstance(source, bytes) else source, "r")
    except OSError as error:
        where = "<memory>" if isinstance(source, bytes) else source
        reason = "no such file" if isinstance(error, FileNotFoundError) else "not a whole HDF5 file"
        raise BadFile(where, reason) from error


def array(node: h5py.Group, key: str) -> np.ndarray:
    """The values of a dataset. Raises `KeyError` when the key is absent or no dataset."""
    # Low-level calls: `node[key][()]` takes six times as long, and a file has dozens.
    try:
        dataset = h5py.h5d.open(node.id, key.encode())
    except (TypeError, ValueError) as error:
        raise KeyError(f"{key} is no dataset") from error
    shape, (dtype, memory) = dataset.shape, _types(dataset.get_type().encode())
    if shape is None:  # an empty dataset
        return np.asarray(h5py.Dataset(dataset)[()])
    data = np.empty(shape, dtype)
    if data.size:
        dataset.read(h5py.h5s.ALL, h5py.h5s.ALL, data, memory)
    return data


@lru_cache(maxsize=256)
def _types(encoded: bytes) -> tuple[np.dtype, h5py.h5t.TypeID]:
    """The numpy type of an HDF5 type, and its HDF5 type in memory; both are slow to derive."""
    dtype = h5py.h5t.decode(encoded).dtype
    return dtype, h5py.h5t.py_create(dtype)


def text(node: h5py.Group, key: str) -> str:
    """A scalar text dataset. Raises `KeyError`, or `ValueError` when it is not UTF-8 text."""
    value = array(node, key).item()
    if not isinstance(value, bytes | str):
        raise ValueError(f"{key} is no text")
    return value.decode() if isinstance(value, bytes) else value


def group(node: h5py.Group, key: str) -> h5py.Group:
    """A group below another. Raises `KeyError` when the key is absent or no group."""
    below = node[key]
    if not isinstance(below, h5py.Group):
        raise KeyError(f"{key} is no group")
    return below


def arrays(node: h5py.Group, key: str) -> dict[str, np.ndarray]:
    """The datasets directly below a group, by name; empty when the group is absent."""
    if key not in node:
        return {}
    below = group(node, key)
    return {str(name): array(below, str(name)) for name in below}


def note(node: h5py.Group, key: str) -> str:
    """A text attribute. Raises `KeyError`."""
    return str(node.attrs[key])


def content_digest(source: Path | bytes) -> str:
    """SHA-256 over every group, dataset and attribute: names, types, shapes and values.

    Independent of where HDF5 puts the bytes, so two files with equal content agree even when
    written by different library versions.
    """
    digest = hashlib.sha256()

    def visit(name: str, node: h5py.Group | h5py.Dataset) -> None:
        digest.update(f"{type(node).__name__} {name}\n".encode())
        for key in sorted(node.attrs):
            _feed(digest.update, f"@{key}", node.attrs[key])
        if isinstance(node, h5py.Dataset):
            _feed(digest.update, "=", node[()])

    with open_read(source) as file:
        visit("/", file)
        file.visititems(visit)
    return digest.hexdigest()


def _feed(update: Callable[[bytes], None], label: str, value: object) -> None:
    data = np.asarray(value)
    if data.dtype.kind in "OU":  # text: one length-prefixed item after the other
        items = [t if isinstance(t, bytes) else str(t).encode() for t in data.ravel().tolist()]
        update(f"{label} text {data.shape}\n".encode())
        for item in items:
            update(f"{len(item)}:".encode() + item)
        return
    update(f"{label} {data.dtype.str} {data.shape}\n".encode())
    update(np.ascontiguousarray(data).tobytes())
