"""Writes the builtin pack: in parallel, whole or not at all, the same bytes each time."""

import hashlib
import json
import os
import shutil
import subprocess
import sys
import tempfile
from collections.abc import Iterable
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from importlib import metadata
from pathlib import Path
from queue import Queue

from rtphys.assets.asset_model import Machine
from rtphys.assets.embodiments import EMBODIMENTS
from rtphys.assets.objects import catalogue
from rtphys.assets.pack import STAMP, Pack, Progress
from rtphys.assets.textures import texture_names, write_texture
from rtphys.assets.write import write_machine, write_thing
from rtphys.core import arithmetic

FORMAT = 1  # of the pack, raised when the loader could no longer read an older one
LIBRARIES = ("manifold3d", "numpy", "scipy")  # whose version may move a vertex
FEW = 12  # jobs that are not worth starting processes for


@dataclass(frozen=True, order=True)
class Job:
    """One thing to write. Names only, so that it can be sent to another process."""

    kind: str  # "embodiment", "object" or "texture"
    name: str
    index: int = 0

    def __str__(self) -> str:
        return f"{self.name}/{self.index}" if self.kind == "object" else self.name


def jobs(names: Iterable[str] = ()) -> list[Job]:
    """Everything the pack holds, or only what has one of these names."""
    wanted = set(names)
    every = [Job("embodiment", name) for name in EMBODIMENTS]
    every += [Job("object", name, i) for name, makers in catalogue().items() for i in makers]
    every += [Job("texture", name) for name in texture_names()]
    return [job for job in every if not wanted or job.name in wanted]


def write(root: Path, job: Job) -> Job:
    """Make and write one job's files under `root`."""
    if job.kind == "embodiment":
        EMBODIMENTS[job.name](root / "embodiments" / job.name)
        return job
    if job.kind == "texture":
        write_texture(root / "textures", job.name)
        return job
    folder = root / "objects" / job.name
    made = catalogue()[job.name][job.index]()
    if isinstance(made, Machine):
        write_machine(folder / str(job.index), made)
    else:
        write_thing(folder, job.index, made)
    return job


def build(
    out: Path,
    progress: Progress | None = None,
    names: Iterable[str] = (),
    workers: int | None = None,
) -> Pack:
    """Write the pack to `out`, which then holds all of it; an older pack there is replaced.

    Args:
        out: folder to make. Nothing of it is touched before everything is written.
        progress: told (done, total, name) after each model.
        names: only these objects, robots and textures (for authors); all if empty.
        workers: processes, at least one, whose arithmetic is pinned even where the caller's is not
            (see `rtphys.core.arithmetic`); by default one a core, and none for a handful of models.
    """
    out = Path(out).expanduser()
    out.parent.mkdir(parents=True, exist_ok=True)
    todo = jobs(names)
    scratch = Path(tempfile.mkdtemp(prefix=f".{out.name}-", dir=out.parent))
    try:
        for part in ("objects", "embodiments"):
            (scratch / part).mkdir()
        _write_all(scratch, todo, progress, workers)
        stamp = {
            "format": FORMAT,
            "digest": content_digest(scratch),
            "source": source_digest(),
            "models": sum(job.kind == "object" for job in todo),
        }
        (scratch / STAMP).write_text(json.dumps(stamp, indent=1) + "\n")
        scratch.chmod(0o755)
        _install(scratch, out)
    finally:
        shutil.rmtree(scratch, ignore_errors=True)
    return Pack(out)


def content_digest(root: Path) -> str:
    """SHA-256 over the names and bytes of all files under `root`."""
    total = hashlib.sha256()
    files = [p for p in root.rglob("*") if p.is_file() and p.name != STAMP]
    for path in sorted(files, key=lambda p: p.relative_to(root).as_posix()):
        total.update(f"{path.relative_to(root).as_posix()}\0{path.stat().st_size}\0".encode())
        total.update(path.read_bytes())
    return total.hexdigest()


def source_digest() -> str:
    """SHA-256 over the generators' own code, the libraries they compute with, and how.

    It can be had without building, so it names the cached pack's folder.
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


def _write_all(root: Path, todo: list[Job], progress: Progress | None, workers: int | None) -> None:
    count = max(workers if workers is not None else min(os.cpu_count() or 1, 8), 1)
    if len(todo) <= FEW:
        for done, job in enumerate(todo, 1):
            write(root, job)
            _tell(progress, done, todo, job)
        return
    finished: Queue[Job | Exception] = Queue()
    with ThreadPoolExecutor(count) as threads:
        for i in range(count):
            threads.submit(_run_worker, root, todo[i::count], finished)
        for done in range(1, len(todo) + 1):
            job = finished.get()
            if isinstance(job, Exception):
                raise job
            _tell(progress, done, todo, job)


def _run_worker(root: Path, share: list[Job], finished: "Queue[Job | Exception]") -> None:
    """One process for these jobs; puts each into `finished`, or what stopped it.

    A plain command and not multiprocessing, which would run the caller's main module again: that
    may be a notebook, or a script without a guard.
    """
    source = str(Path(__file__).parents[2])
    env = os.environ | {"PYTHONPATH": os.pathsep.join([source, os.environ.get("PYTHONPATH", "")])}
    command = [sys.executable, "-m", "rtphys.assets.worker", str(root)]
    with tempfile.TemporaryFile("w+") as orders, tempfile.TemporaryFile("w+") as said:
        orders.write("".join(f"{job.kind} {job.name} {job.index}\n" for job in share))
        orders.seek(0)
        with subprocess.Popen(
            command, stdin=orders, stdout=subprocess.PIPE, stderr=said, text=True, env=env
        ) as process:
            for job, _ in zip(share, process.stdout or (), strict=False):
                finished.put(job)
        if process.returncode:
            said.seek(0)
            finished.put(RuntimeError(f"a generator failed:\n{said.read()[-2000:]}"))


def _tell(progress: Progress | None, done: int, todo: list[Job], job: Job) -> None:
    if progress is not None:
        progress(done, len(todo), str(job))


def _install(scratch: Path, out: Path) -> None:
    """Put the finished folder in place; a pack found there is moved aside first."""
    if out.exists():
        old = Path(tempfile.mkdtemp(prefix=f".{out.name}-old-", dir=out.parent))
        out.rename(old / "pack")
        scratch.rename(out)
        shutil.rmtree(old, ignore_errors=True)
    else:
        scratch.rename(out)
