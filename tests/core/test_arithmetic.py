"""A state's last bit must not tell the processor it was computed on."""

import os
import subprocess
import sys
import warnings

import pytest

from rtphys import doctor
from rtphys.core import arithmetic

PLAIN = frozenset({"avx2", "fma"})
WIDE = PLAIN | {arithmetic.AVX512}

# Lengths that reach the wide loops and their remainders.
SUMS = """
import hashlib
import numpy as np
import scipy.linalg
rng = np.random.default_rng(7)
total = hashlib.sha256()
for n in (3, 6, 14, 33, 200):
    a, v = rng.normal(size=(n, n)), rng.normal(size=n)
    for found in (np.sin(9 * v), np.cos(9 * v), np.exp(v), np.arctan2(v, a[0]), a @ a, a @ v, v @ v,
                  np.linalg.inv(a), *np.linalg.svd(a), scipy.linalg.lu(a)[2], a.sum(axis=1)):
        total.update(np.ascontiguousarray(found).tobytes())
print(total.hexdigest())
"""

# A processor of another machine.
AVX512 = """
import io, pathlib
def opened(path, mode="r", buffering=-1, encoding=None, errors=None, newline=None):
    if str(path) == "/proc/cpuinfo":
        return io.StringIO("flags: fpu avx2 fma avx512f")
    return io.open(path, mode, buffering, encoding, errors, newline)
pathlib.Path.open = opened
"""
REASON = "print(a.mismatch_reason())"


def run(code: str, environment: dict[str, str]) -> str:
    """What fresh Python prints, without what this process was told."""
    clean = {name: value for name, value in os.environ.items() if name not in arithmetic.PINS}
    done = subprocess.run(
        [sys.executable, "-c", code], env=clean | environment, capture_output=True, text=True
    )
    assert done.returncode == 0, done.stderr
    return done.stdout.strip()


def test_sums_end_in_the_bits_that_processors_with_avx2_share() -> None:
    pinned = run("import rtphys.core.pinned" + SUMS, {})
    assert pinned == run(SUMS, arithmetic.PINS)
    assert pinned == run("import rtphys.core.pinned" + SUMS, arithmetic.PINS)


def test_numpy_leaves_avx512_unused() -> None:
    found = "numpy.show_config('dicts')['SIMD Extensions']['found']"
    code = f"import rtphys.core.pinned, numpy; print(*{found})"
    groups = run(code, {}).split()
    assert not [group for group in groups if group == "X86_V4" or "AVX512" in group]


@pytest.mark.parametrize("module", ["cli", "gym", "episode", "sim", "assets.worker"])
def test_what_simulates_pins_before_numpy_is_loaded(module: str) -> None:
    code = f"{AVX512}import rtphys.{module}; from rtphys.core import arithmetic as a; {REASON}"
    assert run(code, {}) == ""


def test_reading_a_dataset_changes_nothing_of_the_process() -> None:
    code = f"{AVX512}import os, rtphys; rtphys.Dataset; from rtphys.core import arithmetic as a; "
    assert run(code + "print(a.PINS.keys() & os.environ.keys())", {}) == "set()"
    code += "import rtphys.gym; "
    assert "import rtphys.gym or rtphys.episode before it" in run(code + REASON, {})


def test_these_tests_compute_as_rtphys_does() -> None:
    assert arithmetic.mismatch_reason() == ""
    assert doctor.check_arithmetic().status == "ok"


def test_the_flags_are_those_of_the_first_processor() -> None:
    lines = ["processor\t: 0\n", "flags\t\t: fpu avx2 fma\n", "\n", "flags\t\t: fpu avx512f\n"]
    assert arithmetic.flags(lines) == {"fpu", "avx2", "fma"}
    assert arithmetic.flags(["Features : neon\n"]) == frozenset()


@pytest.fixture
def processor(monkeypatch: pytest.MonkeyPatch) -> pytest.MonkeyPatch:
    """Of x86-64; the test says what it can do. Nothing is set, nothing came too late."""
    for name in arithmetic.PINS:
        monkeypatch.setenv(name, "")  # so that what `pin` sets is taken back where nothing was set
        monkeypatch.delenv(name)
    monkeypatch.setattr(arithmetic.platform, "machine", lambda: "x86_64")
    monkeypatch.setattr(arithmetic, "_loaded_before", set())
    monkeypatch.setattr(arithmetic, "cpu_features", lambda: WIDE)
    return monkeypatch


def test_without_avx512_there_is_nothing_to_pin(processor: pytest.MonkeyPatch) -> None:
    processor.setattr(arithmetic, "cpu_features", lambda: PLAIN)
    arithmetic.pin()
    assert not arithmetic.PINS.keys() & os.environ.keys()
    assert arithmetic.mismatch_reason() == ""


def test_pinning_before_numpy_is_complete(processor: pytest.MonkeyPatch) -> None:
    processor.delitem(sys.modules, "numpy")
    arithmetic.pin()
    assert arithmetic.mismatch_reason() == ""
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        arithmetic.warn()


def test_pinning_after_numpy_is_told_with_the_cure(processor: pytest.MonkeyPatch) -> None:
    arithmetic.pin()
    assert "import rtphys.gym or rtphys.episode before it" in arithmetic.mismatch_reason()
    with pytest.warns(UserWarning, match='OPENBLAS_CORETYPE="Haswell"'):
        arithmetic.warn()
    assert doctor.check_arithmetic().status == "note"
    assert os.environ["OPENBLAS_CORETYPE"] == "Haswell"  # for child processes


def test_what_somebody_has_set_is_kept_and_told(processor: pytest.MonkeyPatch) -> None:
    processor.setenv("OPENBLAS_CORETYPE", "SkylakeX")
    processor.delitem(sys.modules, "numpy")
    arithmetic.pin()
    assert os.environ["OPENBLAS_CORETYPE"] == "SkylakeX"
    assert 'OPENBLAS_CORETYPE="SkylakeX"' in arithmetic.mismatch_reason()


@pytest.mark.parametrize(
    ("machine", "names", "told"),
    [("aarch64", WIDE, "aarch64"), ("x86_64", frozenset({"fma"}), "avx2")],
)
def test_other_processors_are_told(
    processor: pytest.MonkeyPatch, machine: str, names: frozenset[str], told: str
) -> None:
    processor.setattr(arithmetic, "cpu_features", lambda: names)
    processor.setattr(arithmetic.platform, "machine", lambda: machine)
    assert told in arithmetic.mismatch_reason()


def test_a_total_is_the_same_in_every_python() -> None:
    """Python's own sum compensates rounding since 3.12, and gives 1 here."""
    assert arithmetic.total([1e16, 1.0, -1e16]) == 0.0
    assert arithmetic.total([]) == 0.0
