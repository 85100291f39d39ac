"""Makes numpy and OpenBLAS compute the same bits on every x86-64 processor.

numpy and OpenBLAS contain code for several kinds of processor and choose when they are loaded. The
code for AVX-512 rounds differently from the code for AVX2, and after thousands of contact steps a
different last bit is a different trajectory and state hash. So whatever simulates asks both for the
code that all processors with AVX2 share, before it loads either (`rtphys.core.pinned`). Its small
matrices lose no speed. `import rtphys` alone changes nothing: a training may use AVX-512.
"""

import os
import platform
import sys
import warnings
from collections.abc import Iterable
from functools import lru_cache
from importlib import metadata
from pathlib import Path

AVX512 = "avx512f"  # Linux's name of the instructions that the pinned-out code needs
NEEDED = frozenset({"avx2", "fma"})  # without them OpenBLAS and the C library's sin and cos differ

# numpy calls groups of instructions by other names since 2.4, and warns of names it does not know.
GROUPS = "X86_V4 AVX512_ICL AVX512_SPR"
OLDER_GROUPS = "AVX512F AVX512CD AVX512_SKX AVX512_CLX AVX512_CNL AVX512_ICL AVX512_SPR"


def _groups() -> str:
    try:
        major, minor = metadata.version("numpy").split(".")[:2]
        return GROUPS if (int(major), int(minor)) >= (2, 4) else OLDER_GROUPS
    except (metadata.PackageNotFoundError, ValueError):  # a build of one's own is a new one
        return GROUPS


# OpenBLAS's kernels for Haswell and Zen give the same bits.
PINS = {"OPENBLAS_CORETYPE": "Haswell", "NPY_DISABLE_CPU_FEATURES": _groups()}
_loaded_before: set[str] = set()  # pins that were set too late for this process


def total(values: Iterable[float]) -> float:
    """The sum, added from the first to the last: since 3.12, Python's own compensates rounding."""
    result = 0.0
    for value in values:
        result += value
    return result


@lru_cache(maxsize=1)
def cpu_features() -> frozenset[str]:
    """Instruction sets of the processor, in Linux's names; empty where they cannot be read."""
    try:
        with Path("/proc/cpuinfo").open() as lines:
            return flags(lines)
    except OSError:
        return frozenset()


def flags(lines: Iterable[str]) -> frozenset[str]:
    """Flags of the first processor in `/proc/cpuinfo`, which lists every core."""
    first = next((line for line in lines if line.startswith("flags")), "")
    return frozenset(first.partition(":")[2].split())


def pin() -> None:
    """Ask for the shared code, for libraries not yet loaded here and for child processes.

    A variable that is already set stays as it is; `mismatch_reason` then says so.
    """
    if AVX512 in cpu_features():
        if "numpy" in sys.modules:
            _loaded_before.update(name for name in PINS if name not in os.environ)
        for name, value in PINS.items():
            os.environ.setdefault(name, value)


def mismatch_reason() -> str:
    """Why simulated states differ here from those of other machines; empty if they do not."""
    if platform.machine() not in ("x86_64", "AMD64"):
        return f"the processor is {platform.machine()}, not x86-64"
    if missing := NEEDED - cpu_features():
        return f"the processor is not known to have {' and '.join(sorted(missing))}"
    if AVX512 not in cpu_features():
        return ""
    if _loaded_before:
        return (
            "numpy was imported first and computes with AVX-512; import rtphys.gym or "
            "rtphys.episode before it, or set "
            + " ".join(f'{name}="{PINS[name]}"' for name in sorted(_loaded_before))
        )
    now = {name: os.environ.get(name, "") for name in PINS}
    other = [n for n, words in PINS.items() if not set(words.split()) <= set(now[n].split())]
    said = " and ".join(f'{name}="{now[name]}"' for name in other)
    return f"{said} is in force, not what rtphys would set" if said else ""


def warn() -> None:
    """Warn if this process computes other bits than it would with the right settings."""
    if AVX512 in cpu_features() and (reason := mismatch_reason()):
        warnings.warn(f"states may differ from other machines': {reason}", stacklevel=3)
