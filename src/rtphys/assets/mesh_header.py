"""Whether a mesh file begins as its kind should: readers crash, or go on without it, where not."""

import re
import struct
from collections.abc import Callable, Mapping
from pathlib import Path

from rtphys.core.errors import BadFile

_READ = 4096  # [bytes] of the beginning
_OBJ_LINE = re.compile(rb"^\s*(#|(v|vn|vt|f|g|o|s|mtllib|usemtl)\s)", re.MULTILINE)


def check_mesh(path: Path) -> None:
    """Look at the beginning and the size of a .glb, .stl, .obj or .dae; others pass.

    Raises:
        BadFile: it cannot be read, or is none of its kind.
    """
    check = _KINDS.get(path.suffix.lower())
    if check is None:
        return
    try:
        with path.open("rb") as file:
            head = file.read(_READ)
            size = path.stat().st_size
    except OSError as error:
        raise BadFile(path, (error.strerror or "cannot be read").lower()) from error
    if problem := check(head, size):
        raise BadFile(path, f"is no readable mesh: {problem}")


def _glb(head: bytes, size: int) -> str:
    if len(head) < 20 or head[:4] != b"glTF" or head[16:20] != b"JSON":
        return "no binary glTF"
    version, length = struct.unpack_from("<II", head, 4)
    if version != 2:
        return f"binary glTF of version {version}, not 2"
    return "" if size >= length else f"{size} of the {length} bytes that its header states"


def _stl(head: bytes, size: int) -> str:
    if head.lstrip().lower().startswith(b"solid") and b"vertex" in head:
        return ""
    triangles = int.from_bytes(head[80:84], "little")
    if triangles and size >= 84 + 50 * triangles:  # some programs append to it
        return ""
    return "neither an STL text of facets nor a binary STL as long as its triangles are"


def _obj(head: bytes, _: int) -> str:
    return "" if _OBJ_LINE.search(head) else "no Wavefront OBJ"


def _dae(head: bytes, _: int) -> str:
    return "" if b"<COLLADA" in head else "no COLLADA"


_KINDS: Mapping[str, Callable[[bytes, int], str]] = {
    ".glb": _glb,
    ".stl": _stl,
    ".obj": _obj,
    ".dae": _dae,
}
