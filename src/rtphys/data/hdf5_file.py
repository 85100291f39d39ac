"""HDF5 files made in memory, the same bytes for the same content; readers with bounds; a digest."""

import errno
import math
import mmap
import os
import struct
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path
from typing import Any

import cv2
import h5py
import numpy as np
from h5py import h5d, h5i, h5l, h5o, h5s, h5t, h5z  # pyright: ignore[reportAttributeAccessIssue]
from isal import isal_zlib
from numpy.typing import NDArray

from rtphys.core.bounds import (
    DEEPEST_LINK,
    LARGEST_EPISODE,
    MAX_EXPANSION,
    MAX_LINKS,
    MAX_PIXELS,
)
from rtphys.core.errors import BadFile
from rtphys.core.untrusted import open_ordinary, parse

GROUP = "rtphys"  # what the official layouts do not hold, or less exactly
LAST = f"{GROUP}/last"  # what native rows lack of the last frame
TEXT = h5py.string_dtype("utf-8")
PLAIN = (h5t.INTEGER, h5t.FLOAT, h5t.ENUM, h5t.STRING)  # what `put` writes
SMALL = 2**20  # [bytes] of an array that is not compared with the file's size, which takes time
FILTERS = {h5z.FILTER_SHUFFLE, h5z.FILTER_DEFLATE}  # of every HDF5 library
LEVEL = 1  # of ISA-L; level 0 takes a tenth less time and leaves a fifth more bytes
LARGEST_CHUNK = 8 * MAX_PIXELS  # [bytes] a frame of float64
HEAP = b"GCOL\x01"  # the first bytes of a heap of version 1, the only one
HEAP_HEADER = 16  # [bytes]
HEAP_OBJECT = struct.Struct("<H6xQ")  # its number (0: free space), and the bytes it has
MAX_TEXTS = 65536  # of a file; an episode has 30 to 300
MAX_REMEMBERED = 100_000  # files that this process looks through once
_trees: set[tuple[int, ...]] = set()  # stamps of files that were seen to be trees
_heaps: set[tuple[int, ...]] = set()  # and of those whose texts can be read
# What numpy, json and HDF5 raise about a file that is not what it should be.
DAMAGED = (KeyError, TypeError, ValueError, OverflowError, OSError, RecursionError)

# ---- writing -------------------------------------------------------------------------------------


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
    dtype = TEXT if data.dtype.kind == "U" else None
    made = group.create_dataset(key, data=value if dtype else data, dtype=dtype, track_times=False)
    made.attrs.update(notes or {})


def packed(file: h5py.File, key: str, shape: tuple[int, ...], dtype: np.dtype) -> h5py.Dataset:
    """A dataset of frames for `write_packed`, each compressed for itself without loss."""
    options = {"compression": "gzip", "compression_opts": LEVEL, "shuffle": dtype.itemsize > 1}
    chunk = (1, *shape[1:])
    return file.create_dataset(key, shape, dtype, chunks=chunk, track_times=False, **options)


def write_packed(made: h5py.Dataset, index: int, frame: NDArray[Any]) -> None:
    """Writes a frame as HDF5's shuffle and deflate would leave it, in a fifth of their time.

    HDF5 brings zlib, which takes longer over a depth picture than drawing it does. ISA-L writes the
    same format: every HDF5 library reads it with its own zlib.
    """
    raw = np.ascontiguousarray(frame, made.dtype).reshape(-1).view(np.uint8)
    if made.shuffle:  # the first bytes of all numbers, then the second bytes, ...
        raw = cv2.transpose(raw.reshape(-1, made.dtype.itemsize))
    made.id.write_direct_chunk((index, *[0] * (made.ndim - 1)), isal_zlib.compress(raw, LEVEL))


# ---- reading what others may have written --------------------------------------------------------


@contextmanager
def open_read(path: Path) -> Iterator[h5py.File]:
    """Opens a file; every reader opens files so.

    A file is a tree of groups and arrays that lie in the file itself. Nothing in it leads to
    another file, back to a group above, or twice to the same place.

    Raises `BadFile`: it is not HDF5, is too large, or is no such tree. What HDF5 itself raises
    while the file is open becomes a `BadFile` too.
    """
    try:
        with os.fdopen(open_ordinary(path), "rb", buffering=0) as ordinary:
            facts = os.fstat(ordinary.fileno())
        if facts.st_size > LARGEST_EPISODE:
            raise BadFile(path, f"has {facts.st_size} bytes; at most {LARGEST_EPISODE} are read")
        # No lock: nobody changes a file that has its name, and some file systems have none.
        with h5py.File(path, "r", locking=False) as file:
            if stamp(facts) not in _trees:
                if reason := _stray_link(file):
                    raise BadFile(path, reason)
                if len(_trees) < MAX_REMEMBERED:
                    _trees.add(stamp(facts))
            yield file
    except (*DAMAGED, RuntimeError, MemoryError) as error:
        problem = f"not a whole HDF5 file ({error})"
        if number := getattr(error, "errno", None):  # what the system refuses is no damage
            problem = "no such file" if number == errno.ENOENT else os.strerror(number).lower()
        raise BadFile(path, problem) from error


def stamp(facts: os.stat_result) -> tuple[int, ...]:
    """What a file that was not changed keeps."""
    return facts.st_dev, facts.st_ino, facts.st_size, facts.st_mtime_ns


def _stray_link(file: h5py.File) -> str:
    """Why the links are no tree within the file; empty when they are."""
    seen = {h5o.get_info(file.id).addr}

    def reason(name: bytes, link: h5l.LinkInfo) -> str | None:
        shown = name[:80].decode(errors="backslashreplace")
        if link.type != h5l.TYPE_HARD:
            kind = {h5l.TYPE_SOFT: "a soft link", h5l.TYPE_EXTERNAL: "an external link"}
            return f"{shown} is {kind.get(link.type, 'a link of a foreign kind')}"
        if link.u in seen:
            return f"{shown} leads to what another name leads to"
        seen.add(link.u)
        if len(seen) > MAX_LINKS:
            return f"holds more than {MAX_LINKS} names"
        if name.count(b"/") >= DEEPEST_LINK:
            return f"{shown} lies more than {DEEPEST_LINK} groups deep"
        return None

    return file.id.links.visit(reason, info=True) or ""


def dataset(node: h5py.Group, key: str, *, frames: bool = False) -> h5d.DatasetID:
    """A dataset whose values lie in the file in one piece, as `put` writes them.

    External raw storage, virtual datasets, filters and values that were never written are refused.

    Args:
        frames: it may also be one of `packed`; read it frame by frame.

    Raises:
        KeyError: the key is absent or no dataset.
        ValueError: its values lie elsewhere, or are neither numbers nor text.
    """
    try:
        found = h5d.open(node.id, key.encode())
    except (KeyError, TypeError, ValueError) as error:
        raise KeyError(f"{key} is no dataset") from error
    shape, dtype = found.shape, _types(found.get_type().encode())[0]
    if frames and in_chunks(found):
        _check_chunks(found, key, dtype)
        return found
    if shape is None:
        raise ValueError(f"{key} holds nothing")
    size = math.prod(shape) * dtype.itemsize
    if dtype.kind == "O" and shape:  # a few bytes of the file could be the text of each
        raise ValueError(f"{key} holds many texts of any length")
    # Undefined for external, virtual, chunked and compact storage, and where nothing was written.
    if size and found.get_offset() is None:
        raise ValueError(f"the values of {key} do not lie in the file in one piece")
    if size > SMALL and size > h5i.get_file_id(found).get_filesize():
        raise ValueError(f"{key} would have {size} bytes, more than its file")
    return found


def in_chunks(found: h5d.DatasetID) -> bool:
    """Whether its values lie in pieces, as those of `packed` do."""
    return found.get_create_plist().get_layout() == h5d.CHUNKED


def _check_chunks(found: h5d.DatasetID, key: str, dtype: np.dtype) -> None:
    """Raises `ValueError`: it is not what `packed` makes, is not all there, or grows too large."""
    made, shape = found.get_create_plist(), found.shape
    filters = [made.get_filter(n)[0] for n in range(made.get_nfilters())]
    if dtype.kind not in "fu" or len(shape) < 3 or made.get_chunk() != (1, *shape[1:]):
        raise ValueError(f"{key} is not compressed frame by frame")
    if not {*filters} <= FILTERS or len(filters) > len(FILTERS):
        raise ValueError(f"{key} needs filters that not every HDF5 library has")
    frame = math.prod(shape[1:]) * dtype.itemsize
    if frame > LARGEST_CHUNK:
        raise ValueError(f"a frame of {key} has {frame} bytes; at most {LARGEST_CHUNK} are read")
    most = min(MAX_EXPANSION * h5i.get_file_id(found).get_filesize(), LARGEST_EPISODE)
    if shape[0] * frame > most:
        raise ValueError(f"{key} would have {shape[0] * frame} bytes; at most {most} are read")
    if found.get_num_chunks() != shape[0]:
        raise ValueError(f"frames of {key} were never written")


def frame_of(found: h5d.DatasetID, index: int) -> np.ndarray:
    """One frame of a dataset. Raises `ValueError`, `OSError`: it does not decompress."""
    return h5py.Dataset(found)[index]


def array(node: h5py.Group, key: str) -> np.ndarray:
    """The values of a dataset. Raises what `dataset` does."""
    # Low-level calls: `node[key][()]` takes six times as long, and a file has dozens.
    found = dataset(node, key)
    dtype, memory = _types(found.get_type().encode())
    data = np.empty(found.shape, dtype)
    if dtype.kind == "O":
        _check_heaps(node)
    if data.size:
        found.read(h5s.ALL, h5s.ALL, data, memory)
    return data


@lru_cache(maxsize=256)
def _types(encoded: bytes) -> tuple[np.dtype, h5t.TypeID]:
    """The numpy type of an HDF5 type, and its HDF5 type in memory; both are slow to derive."""
    stored = h5t.decode(encoded)
    if stored.get_class() not in PLAIN:
        raise ValueError("holds neither numbers nor text")
    return stored.dtype, h5t.py_create(stored.dtype)


def _check_heaps(node: h5py.Group) -> None:
    """Raises `ValueError`: HDF5 would never end reading a text of this file.

    Texts lie in heaps. HDF5 2.0 goes from object to object of a heap by sizes that it does not
    check, and stays for ever where one takes no room. A heap is known by its first bytes alone, so
    all that look like one are walked, before the first text of a file is read.
    """
    file = node.file
    path = Path(file.filename)
    known = stamp(path.stat())
    if known in _heaps:
        return
    if (sizes := file.id.get_create_plist().get_sizes()) != (8, 8):
        raise ValueError(f"has addresses and sizes of {sizes} bytes; those of 8 are read")
    with (
        path.open("rb") as handle,
        mmap.mmap(handle.fileno(), 0, access=mmap.ACCESS_READ) as whole,
    ):
        walked, start = 0, whole.find(HEAP)
        while start >= 0 and walked <= MAX_TEXTS:
            end = start + int.from_bytes(whole[start + 8 : start + HEAP_HEADER], "little")
            at = start + HEAP_HEADER
            while at + HEAP_OBJECT.size <= end <= len(whole) and walked <= MAX_TEXTS:
                number, size = HEAP_OBJECT.unpack_from(whole, at)
                taken = HEAP_OBJECT.size + -(-size // 8) * 8 if number else size
                if taken < HEAP_OBJECT.size or at + taken > end:
                    raise ValueError(f"the text at byte {at} cannot have {size} bytes")
                at, walked = at + taken, walked + 1
            start, walked = whole.find(HEAP, start + 1), walked + 1
    if walked > MAX_TEXTS:
        raise ValueError(f"holds more than {MAX_TEXTS} texts")
    if len(_heaps) < MAX_REMEMBERED:
        _heaps.add(known)


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


def holds(node: h5py.Group, key: str) -> bool:
    """Whether anything of that name lies below a group."""
    try:  # `key in node` takes ten times as long, and a check asks a dozen times
        return bool(node.id.links.exists(key.encode()))
    except (KeyError, RuntimeError):  # a group on the way there is absent
        return False


def names(node: h5py.Group) -> list[str]:
    """What lies directly below a group."""
    return [name.decode() for name in node.id]


def arrays(node: h5py.Group, key: str) -> dict[str, np.ndarray]:
    """The datasets directly below a group, by name; empty when the group is absent."""
    below = group(node, key) if holds(node, key) else None
    return {} if below is None else {name: array(below, name) for name in names(below)}


def texts(content: str, file: h5py.File) -> tuple[str, ...]:
    """The texts in a JSON list. Raises `ValueError`, `BadFile`: it is none."""
    found = parse(content.encode(), file.filename)
    if not isinstance(found, list) or not all(isinstance(one, str) for one in found):
        raise ValueError("is no list of texts")
    return tuple(map(str, found))


def note(node: h5py.Group, key: str) -> str:
    """A text attribute. Raises `KeyError`, or `ValueError` when it is not one text."""
    found = node.attrs.get_id(key)
    if found.shape != () or found.get_type().get_class() != h5t.STRING:
        raise ValueError(f"@{key} is not one text")
    _check_heaps(node)
    value = np.empty((), found.dtype)
    found.read(value)
    content = value.item()
    return content.decode() if isinstance(content, bytes) else str(content)


# ---- T frames ------------------------------------------------------------------------------------


@dataclass(frozen=True)
class Rows:
    """Where an array of T frames lies: all of them, or all but the last, which lies apart."""

    key: str
    last: str = ""  # empty: there is none apart

    def put(self, file: h5py.File, values: np.ndarray, notes: Mapping[str, str] | None) -> None:
        """Writes T frames."""
        put(file, self.key, values[:-1] if self.last else values, notes)
        if self.last:
            put(file, self.last, values[-1])

    def all(self, file: h5py.File) -> np.ndarray:
        """The T frames. Raises what `dataset` does."""
        rows = array(file, self.key)
        return np.concatenate([rows, array(file, self.last)[None]]) if self.last else rows


def rows_at(layout: str, legacy: str, native: str, camera: str, view: str) -> Rows:
    """Where a layout has what the other has elsewhere. Native files hold T - 1 official rows.

    `{camera}` stands for a camera's official name, `{view}` for that in native files.
    """
    legacy, native = (key.format(camera=camera, view=view) for key in (legacy, native))
    if layout == "legacy":
        return Rows(legacy)
    apart = "" if native.startswith(GROUP) else f"{LAST}/{legacy.removeprefix('observation/')}"
    return Rows(native, apart)
