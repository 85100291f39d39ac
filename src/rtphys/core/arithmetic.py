"""The same last bit on every x86-64 processor.

numpy and OpenBLAS hold code for several kinds of processor and choose when they are loaded. What
they choose with AVX-512 ends in other bits than what they choose without, and thousands of steps
of contact turn a last bit into another trajectory, another state hash. So rtphys asks for the code
that all processors with AVX2 share, before it loads either. Its small matrices lose no speed.
"""

import os
import platform
import sys
import warnings
from collections.abc import Iterable
from functools import lru_cache
from pathlib import Path

AVX512 = "avx512f"  # as Linux names it; numpy and OpenBLAS need it for what is switched off
NEEDED = frozenset({"avx2", "fma"})  # OpenBLAS, and the C library's sin and cos, differ without

# OpenBLAS's kernels for Haswell and Zen give the same bits. Numpy's groups are those of 2.4.
PINS = {"OPENBLAS_CORETYPE": "Haswell", "NPY_DISABLE_CPU_FEATURES": "X86_V4 AVX512_ICL AVX512_SPR"}
_loaded_before: set[str] = set()  # pins that came too late for this process


@lru_cache(maxsize=1)
def abilities() -> frozenset[str]:
    """What the processor can do, in Linux's names; empty where that cannot be read."""
    try:
        with Path("/proc/cpuinfo").open() as lines:
            return flags(lines)
    except OSError:
        return frozenset()


def flags(lines: Iterable[str]) -> frozenset[str]:
    """Those of the first processor: the file is long on a large machine."""
    found = next((line for line in lines if line.startswith("flags")), "")
    return frozenset(found.partition(":")[2].split())


def pin() -> None:
    """Asks for the shared code, of libraries not yet loaded and of child processes.

    Who has set one of the variables keeps it; `unlike` then tells.
    """
    if AVX512 in abilities():
        if "numpy" in sys.modules:
            _loaded_before.update(name for name in PINS if name not in os.environ)
        for name, value in PINS.items():
            os.environ.setdefault(name, value)


def unlike() -> str:
    """Why states end in other bits here than on other machines; empty if they do not."""
    if platform.machine() not in ("x86_64", "AMD64"):
        return f"the processor is {platform.machine()}, not x86-64"
    if missing := NEEDED - abilities():
        return f"the processor is not known to have {' and '.join(sorted(missing))}"
    if AVX512 not in abilities():
        return ""
    if _loaded_before:
        return (
            "numpy was imported before rtphys and computes with AVX-512; import rtphys first, or "
            "set " + " ".join(f'{name}="{PINS[name]}"' for name in sorted(_loaded_before))
        )
    other = [f'{name}="{os.environ.get(name, "")}"' for name in PINS if _differs(name)]
    return f"{' and '.join(other)} is in force, not what rtphys would set" if other else ""


def _differs(name: str) -> bool:
    return not set(PINS[name].split()) <= set(os.environ.get(name, "").split())


def warn() -> None:
    """A warning in a process that computes unlike others and need not."""
    if AVX512 in abilities() and (reason := unlike()):
        warnings.warn(f"states may differ from other machines': {reason}", stacklevel=3)
