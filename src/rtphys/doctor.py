"""What keeps this machine from working, and the cure.

Drivers and compiled packages may hang or crash: a child process with a time limit tries them. Only
numpy and scipy are loaded here before that. Each cause has an exit code of its own, so that scripts
can tell them apart.
"""

import json
import os
import re
import shutil
import signal
import subprocess
import sys
from collections import Counter
from collections.abc import Callable, Sequence
from contextlib import suppress
from dataclasses import asdict, dataclass, replace
from functools import cache
from importlib import metadata
from pathlib import Path

from rtphys.assets.identity import source_digest
from rtphys.assets.pack import STAMP, cache_folder, chosen_pack, default_pack, linked
from rtphys.core import arithmetic, library
from rtphys.core.cache import NoCache, reading_cache
from rtphys.core.errors import RtphysError, counted

PROBE = (sys.executable, "-P", "-W", "ignore", "-m", "rtphys.sim.probe")
COMPILED = (sys.executable, "-P", "-W", "ignore", "-m", "rtphys.core.dependencies")
PROBE_LIMIT = 120.0  # [s] the slowest honest first frame takes about 10, imports take less
OPENCV = ("opencv-contrib-python-headless", "opencv-python-headless")  # either will do
CLAUSES = 3  # differences of stale lists that are named
DISK_LOW, DISK_NEEDED = 5e9, 5e8  # [bytes] warn, fail; an episode is about 5 MB

_DRIVER = (
    "install Mesa's CPU driver: `sudo apt-get install mesa-vulkan-drivers` (on Debian 12 add "
    "`-t bookworm-backports`; `make setup` in a checkout does both)"
)


@dataclass(frozen=True)
class Cause:
    """A thing that can be wrong."""

    exit_code: int
    meaning: str
    cure: str


CAUSES = {
    "ok": Cause(0, "works", ""),
    "no_simulator": Cause(
        10,
        "the simulator cannot be loaded",
        "SAPIEN links libX11: `sudo apt-get install libx11-6`; else reinstall rtphys",
    ),
    "no_loader": Cause(
        11, "there is no Vulkan loader", "`sudo apt-get install libvulkan1`, then " + _DRIVER
    ),
    "no_driver": Cause(12, "there is no Vulkan driver", _DRIVER),
    "old_driver": Cause(
        13, "the Vulkan driver lacks descriptorBindingPartiallyBound", "a newer Mesa: " + _DRIVER
    ),
    "no_permission": Cause(
        14,
        "the graphics device may not be opened by this user",
        "`sudo usermod -aG render,video $USER`, then log in again; or " + _DRIVER,
    ),
    "crashed": Cause(
        15,
        "the Vulkan driver crashes",
        "update the driver, or choose the CPU one: VK_DRIVER_FILES=/usr/share/vulkan/icd.d/"
        "lvp_icd.json (the name may carry the architecture)",
    ),
    "timeout": Cause(
        16, "no picture within the time limit", "as for a crash; or the machine is overloaded"
    ),
    "no_frame": Cause(
        17, "SAPIEN has a device but draws no picture", "update the driver: " + _DRIVER
    ),
    "no_disk": Cause(20, "the disk is full", "free some space"),
    "not_writable": Cause(
        21, "this user cannot write to a folder", "choose another one, or give the right to write"
    ),
    "old_package": Cause(
        22, "a package is missing or too old", "`pip install --upgrade rtphys`, or `make setup`"
    ),
    "not_loadable": Cause(
        23,
        "a compiled package cannot be loaded",
        "install the system library that it names; for cv2, `pip install --force-reinstall "
        "--no-deps opencv-contrib-python-headless` in rtphys's environment",
    ),
    "bad_assets": Cause(
        24,
        "the asset pack is not usable",
        "`rtphys assets link` chooses another, or the builtin one again; a pack in $RTPHYS_ASSETS "
        "goes before both",
    ),
    "bad_library": Cause(25, "the task library is not usable", "check $RTPHYS_LIBRARY"),
    "no_cache": Cause(
        26, "this user cannot use the folder of the built assets", "set XDG_CACHE_HOME to another"
    ),
    "not_a_folder": Cause(
        27, "a file stands where a folder is needed", "choose another folder, or move the file"
    ),
    "unknown": Cause(28, "a check failed itself", "the message may say more"),
}


@dataclass(frozen=True)
class Finding:
    """The outcome of one check: "ok", "note" (works, but worth knowing) or "fail"."""

    check: str
    status: str
    cause: str
    detail: str
    gpus: int = 0  # that draw; 0: a CPU does

    @property
    def cure(self) -> str:
        return CAUSES[self.cause].cure if self.status == "fail" else ""


def examine(out: Path = Path()) -> list[Finding]:
    """Run every check. `out` is where datasets are to go; it need not exist yet."""
    compiled = cache(check_compiled)
    checks: dict[str, Callable[[], Finding]] = {
        "packages": check_packages,
        "certified versions": check_versions,
        "compiled packages": compiled,
        "arithmetic": check_arithmetic,
        "renderer": check_renderer,
        "space for data": lambda: check_disk("space for data", out),
        "space for assets": check_cache,
        "assets": check_assets,
        "library": check_library,
        "certified lists": lambda: check_lists() if compiled().status == "ok" else UNREAD,
    }
    findings: list[Finding] = []
    for check, run in checks.items():
        try:
            findings.append(run())
        except NoCache as error:
            findings.append(_found(check, "no_cache", str(error)))
        except Exception as error:  # one that breaks must not hide the others
            findings.append(_found(check, "unknown", f"{type(error).__name__}: {error}"))
    return findings


UNREAD = Finding("certified lists", "note", "ok", "not compared: a compiled package does not load")


def exit_code(findings: Sequence[Finding]) -> int:
    """The code of the first failure, 0 if there is none."""
    return next((CAUSES[f.cause].exit_code for f in findings if f.status == "fail"), 0)


def to_json(findings: Sequence[Finding]) -> dict[str, object]:
    """Plain JSON of an examination."""
    code, rows = exit_code(findings), [{**asdict(f), "cure": f.cure} for f in findings]
    return {"ok": code == 0, "exit_code": code, "findings": rows}


# ---- in child processes ------------------------------------------------------------------------


def check_renderer(command: Sequence[str] = PROBE, limit_s: float = PROBE_LIMIT) -> Finding:
    """Draw one frame in a child process."""
    cause, facts = probe(command, limit_s)
    detail, gpus = str(facts.get("detail", "")), 0
    devices = facts.get("devices")
    if cause == "ok" and isinstance(devices, list):
        names = [f"{d['name']} (Vulkan {d['api']})" for d in devices]
        kinds = [d.get("kind") for d in devices if d.get("partially_bound")]
        gpus = kinds.count("discrete GPU") or int(any(kind != "CPU" for kind in kinds))
        path = "drawing workers draw for the others" if gpus else "each worker draws on its core"
        detail = f"{', '.join(names)}; first frame after {facts.get('first_frame_s')} s; {path}"
    chosen = [v for v in ("VK_DRIVER_FILES", "VK_ICD_FILENAMES") if os.environ.get(v)]
    if cause != "ok" and chosen:
        detail += f"; ${chosen[0]} = {os.environ[chosen[0]]} limits the choice of drivers"
    return replace(_found("renderer", cause, detail), gpus=gpus)


def probe(command: Sequence[str], limit_s: float) -> tuple[str, dict[str, object]]:
    """(cause, facts) as the probe prints them, or as its exit shows."""
    try:
        done = _run(command, limit_s)
    except subprocess.TimeoutExpired:
        return "timeout", {"detail": f"stopped after {limit_s:g} s"}
    if done.returncode < 0:
        return "crashed", {"detail": f"killed by {signal.Signals(-done.returncode).name}"}
    with suppress(IndexError, ValueError, KeyError, TypeError):
        facts = json.loads(done.stdout.splitlines()[-1])
        if facts["cause"] in CAUSES:
            return facts["cause"], facts
    last = (done.stderr.strip() or "it said nothing").splitlines()[-1]
    return "no_simulator", {"detail": last}


def _run(command: Sequence[str], limit_s: float) -> subprocess.CompletedProcess[str]:
    return subprocess.run(
        command,
        capture_output=True,
        text=True,
        errors="replace",  # a driver writes what it likes
        timeout=limit_s,
        stdin=subprocess.DEVNULL,
    )


def check_compiled(command: Sequence[str] = COMPILED, limit_s: float = PROBE_LIMIT) -> Finding:
    """Import every compiled package in a child process."""
    try:
        done = _run(command, limit_s)
    except subprocess.TimeoutExpired:
        late = f"importing them was stopped after {limit_s:g} s"
        return _found("compiled packages", "not_loadable", late)
    if done.returncode == 0:
        return _found("compiled packages", "ok", "all can be loaded")
    lines = [*done.stdout.strip().splitlines(), *done.stderr.strip().splitlines()[-1:]]
    if done.returncode < 0:
        lines = [f"importing them was ended by {signal.Signals(-done.returncode).name}"]
    return _found("compiled packages", "not_loadable", "; ".join(lines))


# ---- in this process ---------------------------------------------------------------------------


def check_packages() -> Finding:
    """Every requirement of rtphys is installed, and not older than asked for."""
    wrong = []
    for requirement in metadata.requires("rtphys") or []:
        match = re.fullmatch(r"([\w.-]+)>=([\d.]+)", requirement.replace(" ", ""))
        if match is None:  # an optional extra
            continue
        name, least = match.groups()
        have = next(filter(None, map(_version, OPENCV if name in OPENCV else (name,))), None)
        if have is None:
            wrong.append(f"{name} is missing")
        elif _numbers(have) < _numbers(least):
            wrong.append(f"{name} {have} is older than {least}")
    if wrong:
        return _found("packages", "old_package", ", ".join(wrong))
    python = f"Python {'.'.join(map(str, sys.version_info[:3]))}"
    versions = [f"{name} {_version(name)}" for name in ("rtphys", "sapien", "numpy", "pin")]
    return _found("packages", "ok", ", ".join([python, *versions]))


def _version(package: str) -> str | None:
    """Of an installed package; None where there is none."""
    with suppress(metadata.PackageNotFoundError):
        return metadata.version(package)


def constraints() -> Path:
    """The versions of packages with which lists are certified: what pip takes with `-c`."""
    return library.bundled() / "manifests" / "constraints.txt"


def other_versions() -> list[str]:
    """One clause for each installed package of another version: `numpy 2.2.6, not 2.4.6`."""
    clauses: list[str] = []
    for line in constraints().read_text().splitlines():
        name, _, wanted = line.partition("#")[0].strip().partition("==")
        have = _version(name) if wanted else None  # what is missing is another check's finding
        if have not in (None, wanted):
            clauses.append(f"{name} {have}, not {wanted}")
    return clauses


def check_versions() -> Finding:
    """Whether packages have the versions with which the benchmark's lists were certified."""
    if not (clauses := other_versions()):
        return _found("certified versions", "ok", "all packages as certified")
    cure = f"last bits may differ; for the same: pip install -c {constraints()} rtphys"
    return Finding("certified versions", "note", "ok", f"{'; '.join(clauses)}; {cure}")


def check_arithmetic() -> Finding:
    """Whether an episode ends in the same bits here as on the machines that certified it."""
    if reason := arithmetic.mismatch_reason():
        return Finding("arithmetic", "note", "ok", f"other last bits than elsewhere: {reason}")
    pinned = arithmetic.AVX512 in arithmetic.cpu_features()
    detail = "AVX2, as everywhere" + (" (AVX-512 is left unused)" if pinned else "")
    return _found("arithmetic", "ok", detail)


def check_disk(check: str, folder: Path) -> Finding:
    """Free space and the right to write in `folder`, or where it would be made."""
    place = folder.absolute()
    while not os.path.exists(place):  # noqa: PTH110 - that of a path object may raise
        place = place.parent
    if not place.is_dir():
        return _found(check, "not_a_folder", str(place))
    if not os.access(place, os.W_OK | os.X_OK):
        return _found(check, "not_writable", str(place))
    free = shutil.disk_usage(place).free
    detail = f"{free / 1e9:.1f} GB free at {place}"
    if free < DISK_NEEDED:
        return _found(check, "no_disk", detail)
    return Finding(check, "note" if free < DISK_LOW else "ok", "ok", detail)


def check_cache() -> Finding:
    """Space for the builtin pack, and the right to write it, where it is not built yet."""
    if _is_built():
        return _found("space for assets", "ok", "no more is needed, the pack is built")
    found = check_disk("space for assets", cache_folder())
    return replace(found, cause="no_cache") if found.cause == "not_writable" else found


def _is_built() -> bool:
    """Whether the builtin pack of this version is there. Raises `NoCache`."""
    with reading_cache():
        return (_builtin() / STAMP).is_file()


def _builtin() -> Path:
    return cache_folder() / source_digest()[:16]


def check_assets() -> Finding:
    """The pack that a run would use: named, linked or builtin."""
    try:
        link, named = linked(), os.environ.get("RTPHYS_ASSETS")
        root = Path(named) if named else link[0] if link else None
        if root is not None:
            behind = os.environ.get("RTPHYS_ASSETS_FALLBACK", "") if named else ""
            # Without the builtin pack, which would be built; a wrong name is refused.
            behind = "" if behind == "builtin" else behind
            pack = chosen_pack(root, behind)
            return _found("assets", "ok", f"{pack.root}, {counted(len(pack.names), 'objects')}")
    except NoCache:
        raise
    except (RtphysError, OSError) as error:
        return _found("assets", "bad_assets", str(error))
    if not _is_built():
        return Finding("assets", "note", "ok", "not built yet; the first run builds the pack")
    return _found("assets", "ok", f"builtin pack in {_builtin()}")


def check_library() -> Finding:
    """Tasks and domains can be listed."""
    try:
        tasks, domains = library.names("tasks"), library.names("domains")
    except RtphysError as error:
        return _found("library", "bad_library", str(error))
    if not tasks:
        return _found("library", "bad_library", f"no tasks in {library.bundled()}")
    detail = f"{counted(len(tasks), 'tasks')}, {counted(len(domains), 'domains')}"
    return _found("library", "ok", detail)


def check_lists(folder: Path | None = None) -> Finding:
    """Whether `evaluate` accepts the certified lists that rtphys ships; their headers alone count.

    Args:
        folder: whose folders hold lists; default `manifests/` of rtphys.
    """
    try:  # here, because they load the simulator, which may be what does not work
        from rtphys.episode.fingerprint import fingerprint_of
        from rtphys.results.instances import read_fingerprints
        from rtphys.task.spec import load_task

        pack = default_pack() if _is_built() else None
    except (ImportError, RtphysError) as error:  # which another check has found
        return Finding("certified lists", "note", "ok", f"not compared: {error}")
    tasks, clauses, total, stale = cache(load_task), Counter[str](), 0, 0
    try:
        for path in sorted((folder or library.bundled() / "manifests").glob("*/*.jsonl")):
            for task, listed in read_fingerprints(path).items():
                now = fingerprint_of(tasks(task), path.stem, pack, listed.embodiment)
                if pack is None:
                    now = now.model_copy(update={"assets": listed.assets})
                found = listed.changes(now)
                clauses.update(found)
                total, stale = total + 1, stale + bool(found)
    except RtphysError as error:  # such as an attribute of the user that cannot be loaded
        return _found("certified lists", "bad_library", str(error))
    lists = counted(total, "lists")
    aside = "" if pack else "; their assets were not compared, since the pack is not built yet"
    if not stale:
        return _found("certified lists", "ok", f"{lists}, none is stale{aside}")
    why = [f"{clause} ({count})" for clause, count in clauses.most_common(CLAUSES)]
    if len(clauses) > CLAUSES:
        why.append(f"{len(clauses) - CLAUSES} more differences")
    detail = (
        f"{stale} of {lists} are stale, `rtphys evaluate` refuses them: {'; '.join(why)}{aside}"
    )
    return Finding("certified lists", "note", "ok", detail)


def _found(check: str, cause: str, detail: str) -> Finding:
    return Finding(check, "ok" if cause == "ok" else "fail", cause, detail)


def _numbers(version: str) -> tuple[int, ...]:
    return tuple(int(n) for n in re.findall(r"\d+", version)[:3])
