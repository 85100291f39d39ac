"""What this machine has, or the container that the process is in; what a process has used."""

import math
import os
from collections.abc import Iterator
from contextlib import suppress
from pathlib import Path
from typing import NamedTuple

CGROUPS = Path("/sys/fs/cgroup")
OWN_CGROUP = Path("/proc/self/cgroup")
PAGE, TICK = os.sysconf("SC_PAGE_SIZE"), os.sysconf("SC_CLK_TCK")


def cores() -> int:
    """CPU cores that this process may use: those it is bound to, and its container's quota."""
    counts: list[float] = [len(os.sched_getaffinity(0))]
    for folder in _own_groups(""):
        with suppress(OSError, ValueError):  # ValueError: "max", nothing is bounded
            quota, period = (folder / "cpu.max").read_text().split()
            counts.append(int(quota) / int(period))
    for folder in _own_groups("cpu"):
        with suppress(OSError, ValueError):
            if (quota := int((folder / "cpu.cfs_quota_us").read_text())) > 0:
                counts.append(quota / int((folder / "cpu.cfs_period_us").read_text()))
    return max(1, math.ceil(min(counts)))


def memory() -> float:
    """Memory that this machine has, or that its container may use [bytes]."""
    sizes = [float(os.sysconf("SC_PHYS_PAGES") * PAGE)]
    for controller, name in (("", "memory.max"), ("memory", "memory.limit_in_bytes")):
        for folder in _own_groups(controller):
            with suppress(OSError, ValueError):
                sizes.append(float(int((folder / name).read_text())))
    return min(sizes)


def free_memory() -> float:
    """Memory that new processes may take, of the machine and of its container [bytes]."""
    free = memory()
    with suppress(OSError, ValueError, IndexError):
        text = Path("/proc/meminfo").read_text()
        free = min(free, 1024.0 * int(text.partition("MemAvailable:")[2].split()[0]))
    return free


def _own_groups(controller: str) -> Iterator[Path]:
    """Folders of the control groups around this process. `controller`: empty for version 2."""
    try:
        lines = OWN_CGROUP.read_text().splitlines()
    except OSError:
        return
    for line in lines:
        _, controllers, path = line.split(":", 2)
        if controller in controllers.split(","):
            # In a container the path may be that of the host: its own group is then the root.
            own = Path(path.lstrip("/"))
            yield from (CGROUPS / controller / part for part in (own, *own.parents))


class Usage(NamedTuple):
    """What a process has used since it began."""

    cpu: float = 0.0  # [s] of all its threads
    starved: float = 0.0  # [s] in which its first thread waited for a core

    @staticmethod
    def of(pid: int) -> "Usage":
        """All zero where the kernel does not say."""
        cpu = starved = 0.0
        with suppress(OSError, IndexError, ValueError):
            ticks = Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()
            cpu = (int(ticks[11]) + int(ticks[12])) / TICK
            starved = int(Path(f"/proc/{pid}/schedstat").read_text().split()[1]) / 1e9
        return Usage(cpu, starved)


def resident_bytes(pid: int) -> int:
    """Memory of a process that is not swapped out; 0 where the kernel does not say."""
    try:
        return int(Path(f"/proc/{pid}/statm").read_text().split()[1]) * PAGE
    except OSError:
        return 0
