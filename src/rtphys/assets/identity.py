"""What tells one asset pack from another, and a finished one from one still being built."""

import hashlib
from importlib import metadata
from pathlib import Path

from rtphys.core import arithmetic
from rtphys.core.cache import user_cache

STAMP = "pack.json"  # the builder writes this file last: where it is, the pack is complete
LIBRARIES = ("manifold3d", "numpy", "scipy")  # whose version may move a vertex
DESCRIPTIONS = (".json", ".yml", ".urdf")  # files whose text counts in an official pack's digest


def content_digest(root: Path) -> str:
    """SHA-256 (64 hex digits) over the names and bytes of all files under `root`."""
    total = hashlib.sha256()
    files = [p for p in root.rglob("*") if p.is_file() and p.name != STAMP]
    for path in sorted(files, key=lambda p: p.relative_to(root).as_posix()):
        total.update(_name_and_size(path, root))
        total.update(path.read_bytes())
    return total.hexdigest()


def description_digest(root: Path) -> str:
    """SHA-256 over all names and sizes under `root` and the text of all descriptions.

    For an official pack: its 14 GB of meshes are too much to read for every run. It overlooks a
    mesh that is edited without a change of its size.
    """
    total = hashlib.sha256()
    for path in sorted(p for p in root.rglob("*") if p.is_file()):
        total.update(_name_and_size(path, root))
        if path.suffix in DESCRIPTIONS:
            total.update(path.read_bytes())
    return total.hexdigest()


def source_digest() -> str:
    """SHA-256 over the generators' code, the versions of their libraries, and the arithmetic pins.

    It is known without building anything, so it names the folder of the cached pack.
    """
    here = Path(__file__).parent
    total = hashlib.sha256()
    for path in sorted(here.rglob("*.py"), key=lambda p: p.relative_to(here).as_posix()):
        total.update(path.relative_to(here).as_posix().encode() + b"\0" + path.read_bytes())
    for name in LIBRARIES:
        total.update(f"{name} {metadata.version(name)}\0".encode())
    for name, value in arithmetic.PINS.items():
        total.update(f"{name} {value}\0".encode())
    return total.hexdigest()


def _name_and_size(path: Path, root: Path) -> bytes:
    return f"{path.relative_to(root).as_posix()}\0{path.stat().st_size}\0".encode()


def cache_folder() -> Path:
    """The folder of the built packs, in the user's cache. Raises `NoCache`: there is no home."""
    return user_cache() / "assets"
