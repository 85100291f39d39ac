"""Builds the builtin asset pack in parallel, completely or not at all, the same bytes each time."""

import fcntl
import json
import os
import shutil
import subprocess
import sys
import tempfile
from collections.abc import Callable, Iterable
from concurrent.futures import ThreadPoolExecutor
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path
from queue import Queue

from rtphys.assets.asset_model import ArticulatedModel
from rtphys.assets.embodiments import EMBODIMENTS
from rtphys.assets.identity import STAMP, content_digest, source_digest
from rtphys.assets.objects import catalogue
from rtphys.assets.surfaces import NAMES, write_names
from rtphys.assets.write import write_articulated, write_rigid

Progress = Callable[[int, int, str], None]  # jobs done, jobs in all, name of the one just done

FORMAT = 2  # of the pack; raise it when the loader can no longer read older packs
FEW_JOBS = 12  # up to this many are written without starting processes
MOST_WORKERS = 8  # processes by default; more find too few jobs to share


@dataclass(frozen=True, order=True)
class Job:
    """One model or robot, or the list of surfaces, by names, which can go to another process."""

    kind: str  # "embodiment", "object" or "texture"
    name: str
    index: int = 0

    def __str__(self) -> str:
        return f"{self.name}/{self.index}" if self.kind == "object" else self.name


def jobs(names: Iterable[str] = ()) -> list[Job]:
    """Jobs for everything in the pack, or only for what has one of `names`."""
    wanted = set(names)
    every = [Job("embodiment", name) for name in EMBODIMENTS]
    every += [Job("object", name, i) for name, makers in catalogue().items() for i in makers]
    every.append(Job("texture", NAMES))
    return [job for job in every if not wanted or job.name in wanted]


def write(root: Path, job: Job) -> Job:
    """Generate one job's model, robot or list of surfaces and write its files under `root`."""
    if job.kind == "embodiment":
        EMBODIMENTS[job.name](root / "embodiments" / job.name)
        return job
    if job.kind == "texture":
        write_names(root / "textures")
        return job
    folder = root / "objects" / job.name
    model = catalogue()[job.name][job.index]()
    if isinstance(model, ArticulatedModel):
        write_articulated(folder / str(job.index), model)
    else:
        write_rigid(folder, job.index, model)
    return job


def build_once(out: Path, progress: Progress | None = None) -> None:
    """Builds the whole pack unless it is there; of several processes at once, one alone does."""
    out.parent.mkdir(parents=True, exist_ok=True)
    with (out.parent / f".{out.name}.lock").open("w") as lock:
        with suppress(OSError):  # a file system without locks: each builds, one installs its pack
            fcntl.flock(lock, fcntl.LOCK_EX)
        if not (out / STAMP).is_file():
            build(out, progress)


def build(
    out: Path,
    progress: Progress | None = None,
    names: Iterable[str] = (),
    workers: int | None = None,
) -> Path:
    """Write the builtin pack to the folder `out` (returned).

    A pack already there is replaced, unless it has the same bytes: somebody may be reading it.

    Args:
        out: folder to make. Nothing in it is touched before everything is written.
        progress: called after each job.
        names: only these objects, robots and textures (for authors); all if empty.
        workers: processes, at least one, whose arithmetic is pinned even where the caller's is not
            (see `rtphys.core.arithmetic`); by default one per core, and none for a few jobs.
    """
    out = Path(os.path.expanduser(out))  # noqa: PTH111 - that of a path object may raise
    out.parent.mkdir(parents=True, exist_ok=True)
    todo = jobs(names)
    scratch = Path(tempfile.mkdtemp(prefix=".pack-", dir=out.parent))
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
    return out


def _write_all(root: Path, todo: list[Job], progress: Progress | None, workers: int | None) -> None:
    if len(todo) <= FEW_JOBS:
        for done, job in enumerate(todo, 1):
            write(root, job)
            _report(progress, done, todo, job)
        return
    default = min(os.cpu_count() or 1, MOST_WORKERS)
    count = max(default if workers is None else workers, 1)
    finished: Queue[Job | Exception] = Queue()
    with ThreadPoolExecutor(count) as threads:
        for i in range(count):
            threads.submit(_run_worker, root, todo[i::count], finished)
        for done in range(1, len(todo) + 1):
            job = finished.get()
            if isinstance(job, Exception):
                raise job
            _report(progress, done, todo, job)


def _report(progress: Progress | None, done: int, todo: list[Job], job: Job) -> None:
    if progress is not None:
        progress(done, len(todo), str(job))


def _run_worker(root: Path, share: list[Job], finished: "Queue[Job | Exception]") -> None:
    """Run one process that writes the jobs of `share`, and put each, or an error, in `finished`.

    The process is a plain command. Multiprocessing would run the caller's main module again, which
    may be a notebook, or a script without a `__main__` guard.
    """
    source = str(Path(__file__).parents[2])
    env = os.environ | {"PYTHONPATH": os.pathsep.join([source, os.environ.get("PYTHONPATH", "")])}
    # -P: a file of the user's, such as a random.py in the current folder, hides no module.
    command = [sys.executable, "-P", "-m", "rtphys.assets.worker", str(root)]
    with tempfile.TemporaryFile("w+") as job_lines, tempfile.TemporaryFile("w+") as error_text:
        job_lines.write("".join(f"{job.kind} {job.name} {job.index}\n" for job in share))
        job_lines.seek(0)
        with subprocess.Popen(
            command, stdin=job_lines, stdout=subprocess.PIPE, stderr=error_text, text=True, env=env
        ) as process:
            for job, _ in zip(share, process.stdout or (), strict=False):
                finished.put(job)
        if process.returncode:
            error_text.seek(0)
            problem = error_text.read()[-2000:]
            finished.put(RuntimeError(f"a process that builds the asset pack failed:\n{problem}"))


def _install(scratch: Path, out: Path) -> None:
    """Move the finished folder to `out`; another pack that is there is moved aside first."""
    if (out / STAMP).is_file() and content_digest(out) == content_digest(scratch):
        return
    if out.exists():
        old = Path(tempfile.mkdtemp(prefix=".pack-old-", dir=out.parent))
        out.rename(old / "pack")
        scratch.rename(out)
        shutil.rmtree(old, ignore_errors=True)
    else:
        scratch.rename(out)
