"""HDF5 files that a stranger could make of a sound one: links, storage and shapes that lie."""

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import partial
from pathlib import Path

import cv2
import h5py
import numpy as np

ARRAYS = ("rtphys/time", "rtphys/command/left_arm", "state/left_arm_joint_states")
PICTURES = ("vision/cam_head/colors", "rtphys/last/head_camera/rgb")
TEXTS = ("instruction", "instructions", "data_format_version")
GROUPS = ("rtphys", "rtphys/cameras", "rtphys/object_poses", "vision/cam_head")
TERABYTES = (10**12, 10**15, 10**17)

Forge = Callable[[h5py.File, str, Path], object]


@dataclass(frozen=True)
class Forgery:
    """A change to what lies at a key of an open file."""

    name: str
    key: str
    change: Forge

    def forge(self, file: h5py.File, outside: Path) -> None:
        """`outside`: a file with a secret that no reader may reach."""
        self.change(file, self.key, outside)

    def __str__(self) -> str:
        return f"{self.name} {self.key}"


def forgeries() -> Iterator[Forgery]:
    """Each makes the file one that every reader refuses."""
    for kind in LINKS:
        for key in (*ARRAYS, *PICTURES, *TEXTS, *GROUPS):
            yield Forgery(kind, key, LINKS[kind])
    for kind in STORAGE:
        for key in (*ARRAYS, *PICTURES):
            yield Forgery(kind, key, STORAGE[kind])
    for key in GROUPS:
        yield Forgery("group within itself", key, _within_itself)
    yield Forgery("many names", "extra", _many)
    yield Forgery("deep groups", "deep/" + "d/" * 600, _group)
    yield Forgery("a camera of no name", "rtphys/cameras/x", _group)
    for note in ("joint_names", "stages"):
        for value in (3, np.zeros(9), ["a"] * 3, "[" * 9000, "{", "7", h5py.Empty("f8")):
            yield Forgery(str(value)[:12], note, partial(_note, value))
    for words in ("3", "[]", "{}", "null", "[" * 9000, "\ud800".encode("utf-8", "surrogatepass")):
        yield Forgery(str(words)[:9], "instructions", partial(_put, words))


def jpeg_bomb(height: int = 65000, width: int = 65000) -> bytes:
    """A small stream whose header says another size."""
    stream = bytearray(cv2.imencode(".jpg", np.zeros((16, 16, 3), np.uint8))[1].tobytes())
    at = stream.index(b"\xff\xc0") + 5
    stream[at : at + 4] = height.to_bytes(2, "big") + width.to_bytes(2, "big")
    return bytes(stream)


def _put(value: object, file: h5py.File, key: str, _: Path) -> None:
    del file[key]
    file[key] = value


def _external_link(file: h5py.File, key: str, outside: Path) -> None:
    _put(h5py.ExternalLink(str(outside), f"/{key}"), file, key, outside)


def _link_to_itself(file: h5py.File, key: str, outside: Path) -> None:
    _put(h5py.SoftLink(f"/{key}"), file, key, outside)


def _reference(file: h5py.File, key: str, outside: Path) -> None:
    _put(np.array([file.ref] * 8, h5py.ref_dtype), file, key, outside)


def _taken(file: h5py.File, key: str) -> tuple[tuple[int, ...], np.dtype]:
    """Shape and type of a dataset, which is removed."""
    found = file[key]
    assert isinstance(found, h5py.Dataset)
    shape, dtype = found.shape, found.dtype
    del file[key]
    return shape, dtype


def _external_storage(file: h5py.File, key: str, outside: Path) -> None:
    shape, dtype = _taken(file, key)
    size = max(int(np.prod(shape)), 1) * dtype.itemsize
    file.create_dataset(key, shape or (1,), dtype, external=[(str(outside), 0, size)])


def _virtual(file: h5py.File, key: str, outside: Path) -> None:
    shape, dtype = _taken(file, key)
    layout = h5py.VirtualLayout(shape or (1,), dtype)
    layout[...] = h5py.VirtualSource(str(outside), key, shape or (1,))
    file.create_virtual_dataset(key, layout)


def _compressed(file: h5py.File, key: str, _: Path) -> None:
    _, dtype = _taken(file, key)
    file.create_dataset(key, (2**24,), dtype, chunks=(2**12,), compression="gzip")


def _texts(file: h5py.File, key: str, _: Path) -> None:
    _taken(file, key)
    file.create_dataset(key, data=["x"] * 8, dtype=h5py.string_dtype())


def _declared(rows: int, file: h5py.File, key: str, _: Path) -> None:
    """Contiguous, and never written: a few bytes of the file."""
    shape, _ = _taken(file, key)
    file.create_dataset(key, (rows, *shape[1:]), "S1")


def _twice(file: h5py.File, key: str, _: Path) -> None:
    file["again"] = file[key]


def _within_itself(file: h5py.File, key: str, _: Path) -> None:
    file[f"{key}/again"] = file[key]


def _note(value: object, file: h5py.File, key: str, _: Path) -> None:
    file["rtphys"].attrs[key] = value


def _many(file: h5py.File, key: str, _: Path) -> None:
    for number in range(3000):
        file.create_group(f"{key}/{number}")


def _group(file: h5py.File, key: str, _: Path) -> None:
    file.create_group(key)


LINKS: dict[str, Forge] = {
    "external link": _external_link,
    "soft link to itself": _link_to_itself,
    "soft link up": partial(_put, h5py.SoftLink("/")),
    "object reference": _reference,
}
STORAGE: dict[str, Forge] = {
    "external storage": _external_storage,
    "virtual": _virtual,
    "compressed": _compressed,
    "linked twice": _twice,
    "texts of any length": _texts,
    "empty": partial(_put, h5py.Empty("f8")),
    **{f"{rows} rows": partial(_declared, rows) for rows in TERABYTES},
}
