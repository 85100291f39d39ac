"""What episodes need of a machine, refused before any work starts: space, memory, a renderer."""

import os
import shutil
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from importlib import metadata
from pathlib import Path

from rtphys.core.cache import NoCache, user_cache
from rtphys.core.errors import BadFile, BadValue, Infeasible, NoRenderer, RtphysError
from rtphys.core.library import line_of
from rtphys.doctor import CAUSES, PROBE, check_disk, check_renderer
from rtphys.spec.protocol import VisualRandomization
from rtphys.spec.recording import RecordingSpec
from rtphys.studies.rates import SHARES, Cost, like
from rtphys.task.props import Prop
from rtphys.task.spec import Task

CAMERAS = 3  # with which the costs of tasks are measured
FRAME = 6e4  # [bytes] of three pictures with textures, as a task's cost tells its frames
MAX_FRAMES = 250  # of most episodes
PACKED = 0.25  # what compressing leaves of depth and ids; measured: 0.11
BUFFERED = 4e7  # [bytes] of an episode's scene and of pictures on their way to the encoder
GROUP = 16  # episodes that are drawn at once: more gains little on a GPU
LAYOUTS = 30  # that are searched for models that a pack may lack
LARGEST = 2e9  # [bytes] of what an episode's senses may take: a worker has it in memory twice

DRIVERS = ("/etc/vulkan/icd.d", "/usr/share/vulkan/icd.d", "/usr/local/share/vulkan/icd.d")


@contextmanager
def mistakes_named(task: Task) -> Iterator[None]:
    """Turns what the code of a task raises into a `BadFile` that names the line."""
    try:
        yield
    except RtphysError:
        raise
    except Exception as error:
        if not (line := line_of(error, task.source)):  # of rtphys
            raise
        raise BadFile(task.source, f"raises {type(error).__name__}: {error}{line}") from error


def props_of(task: Task, layouts: int = LAYOUTS, first_seed: int = 0) -> list[Prop]:
    """The props of a task's first layouts, which tell what models a pack needs.

    Raises `BadFile`: its layout raises an error.
    """
    found: list[Prop] = []
    for seed in range(first_seed, first_seed + layouts):
        with suppress(Infeasible), mistakes_named(task):  # another seed has a layout
            found += task.props(seed)
    return found


def first_props(task: Task, first_seed: int = 0) -> list[Prop]:
    """The props of a task's first layout from a seed on; none where no seed soon has one.

    Raises `BadFile`: its layout raises an error.
    """
    seeds = range(first_seed, first_seed + LAYOUTS)
    return next(filter(None, (props_of(task, 1, seed) for seed in seeds)), [])


def check_fits(recording: RecordingSpec) -> None:
    """Refuses senses that would make an episode too large for a worker. Raises `BadValue`."""
    if (size := MAX_FRAMES * recording.frame_bytes()) > LARGEST:
        most = f"an episode has {LARGEST / 1e9:g} GB of them at most, not {size / 1e9:.1f}"
        cure = "name fewer `cameras` or senses, or a smaller `size`"
        raise BadValue("senses", ",".join(recording.senses), f"{most}; {cure}")


def drawn_at_once(recording: RecordingSpec) -> int:
    """How many episodes a process may draw at once, for what they take in its memory."""
    pictures = BUFFERED * recording.picture_scale()
    each = pictures + 2 * MAX_FRAMES * recording.frame_bytes()
    return max(1, min(GROUP, int(LARGEST / each)))


def episode_bytes(
    cost: Cost, recording: RecordingSpec, visual: VisualRandomization | None, most: float = 1.0
) -> float:
    """What one episode takes on average [bytes].

    Args:
        cost: of its task.
        visual: the rules of its look.
        most: times as much as its pictures may take; `MOST` gives an upper bound.
    """
    textured = visual is not None and visual.textures
    whole = most * cost.megabytes * 1e6
    pictures = SHARES[like(textured, varied=True)][1] * whole
    scale = len(recording.official) / CAMERAS * recording.picture_scale()
    return pictures * scale + PACKED * whole / FRAME * recording.frame_bytes()


def check_space(out: Path, needed: float) -> None:
    """Refuses what needs more [bytes] than there is. Raises `RtphysError`."""
    finding = check_disk("space for data", out)
    if finding.status == "fail":
        meaning = CAUSES[finding.cause].meaning
        raise RtphysError(f"{out}: {meaning} ({finding.detail}); {finding.cure}")
    place = next(p for p in (out, *out.absolute().parents) if p.exists())
    if (free := shutil.disk_usage(place).free) < needed:
        amounts = f"about {needed / 1e9:.1f} GB are needed and {free / 1e9:.1f} GB are free"
        raise RtphysError(f"{out}: {amounts}; free some space, or ask for fewer episodes")


def check_drawable(what: str = "pictures", shader: str = "") -> int:
    """Refuses where nothing can be drawn; the number of GPUs, 0 where a CPU draws.

    Raises `NoRenderer`, with the cure.

    It draws a frame in another process, unless one was drawn since the machine was started with
    the drivers of now, which a file of the cache tells.
    """
    stamp, now = None, ""
    with suppress(OSError, NoCache, ValueError):
        drivers = sorted(file for folder in DRIVERS for file in Path(folder).glob("*.json"))
        chosen = [f"{key}={value}" for key, value in sorted(os.environ.items()) if "VK_" in key]
        facts = [f"{file} {file.stat().st_mtime_ns}" for file in drivers]
        started = Path("/proc/sys/kernel/random/boot_id").read_text()
        now = "\n".join([*chosen, *facts, f"sapien {metadata.version('sapien')}", started])
        stamp = user_cache() / f"drawn-{shader or 'default'}.txt"
        if stamp.is_file() and (known := stamp.read_text().rpartition("\n"))[0] == now:
            return int(known[2])
    finding = check_renderer((*PROBE, shader) if shader else PROBE)
    if finding.status == "fail":
        cure = f"; cure: {finding.cure}" if finding.cure else ""
        raise NoRenderer(f"no {what} can be drawn: {finding.detail}{cure}")
    if stamp is not None:
        with suppress(OSError, ValueError):  # a path need not be text
            stamp.parent.mkdir(parents=True, exist_ok=True)
            stamp.write_text(f"{now}\n{finding.gpus}")
    return finding.gpus
