"""The wheel holds all, works where the checkout is unknown, and is the same from an sdist."""

import os
import subprocess
import sys
import venv
import zipfile
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[1]
OUTSIDE = {k: v for k, v in os.environ.items() if not k.startswith(("PYTHON", "RTPHYS"))}


def run(*command: str | Path, cwd: Path) -> str:
    done = subprocess.run(
        [str(part) for part in command], cwd=cwd, env=OUTSIDE, capture_output=True, text=True
    )
    assert done.returncode == 0, f"{command}\n{done.stdout}\n{done.stderr}"
    return done.stdout


@pytest.fixture(scope="module")
def wheel(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return wheel_of(ROOT, tmp_path_factory.mktemp("wheel"))


def wheel_of(source: Path, folder: Path) -> Path:
    run(sys.executable, "-m", "pip", "wheel", "--no-deps", "-w", folder, source, cwd=folder)
    return next(folder.glob("rtphys-*.whl"))


def contents(wheel: Path) -> dict[str, bytes]:
    with zipfile.ZipFile(wheel) as file:
        return {name: file.read(name) for name in file.namelist()}


def entries(kind: str, suffix: str) -> set[str]:
    return {p.stem for p in (ROOT / kind).glob(f"*{suffix}") if not p.name.startswith("_")}


@pytest.mark.slow
def test_wheel_holds_the_library_and_nothing_else(wheel: Path) -> None:
    names = zipfile.ZipFile(wheel).namelist()
    tops = {name.partition("/")[0] for name in names}
    assert tops == {"rtphys", next(t for t in tops if t.endswith(".dist-info"))}
    for kind, suffix in (("tasks", ".py"), ("domains", ".yaml"), ("manifests", ".yaml")):
        packed = {n for n in names if n.startswith(f"rtphys/{kind}/") and n.endswith(suffix)}
        assert {Path(n).name for n in packed} >= {p.name for p in (ROOT / kind).glob(f"*{suffix}")}
    examples = {f"rtphys/{p.relative_to(ROOT)}" for p in (ROOT / "examples").rglob("*.py")}
    assert examples <= set(names)
    assert any(n.endswith(".dist-info/licenses/LICENSE") for n in names)
    assert not [n for n in names if "__pycache__" in n or "/." in n]


@pytest.mark.slow
def test_an_sdist_gives_the_same_wheel(wheel: Path, tmp_path: Path) -> None:
    venv.create(tmp_path / "build", with_pip=True)
    python = tmp_path / "build" / "bin" / "python"
    run(python, "-m", "pip", "install", "--quiet", "build", cwd=tmp_path)
    run(python, "-m", "build", "--sdist", "--outdir", tmp_path, ROOT, cwd=tmp_path)
    assert contents(wheel_of(next(tmp_path.glob("rtphys-*.tar.gz")), tmp_path)) == contents(wheel)


@pytest.mark.slow
def test_installed_wheel_works_outside_the_checkout(wheel: Path, tmp_path: Path) -> None:
    home = tmp_path / "environment"
    venv.create(home, with_pip=True)
    python = home / "bin" / "python"
    run(python, "-m", "pip", "install", "--quiet", "--no-compile", wheel, cwd=tmp_path)
    code = (
        "from rtphys.core import library as L; "
        "print(L.bundled()); print(*L.names('tasks')); print(*L.names('domains'))"
    )
    where, tasks, domains = run(python, "-c", code, cwd=tmp_path).splitlines()
    assert Path(where).is_relative_to(home)
    assert set(tasks.split()) == entries("tasks", ".py")
    assert set(domains.split()) == entries("domains", ".yaml")
    assert "collect" in run(home / "bin" / "rtphys", "--help", cwd=tmp_path)
    own = ("--library", "examples/own_attributes", "domains", "show", "thick_air")
    assert "linear_drag" in run(home / "bin" / "rtphys", *own, cwd=tmp_path)
    assert "global" in run(home / "bin" / "rtphys", "domains", "list", cwd=tmp_path)
    # sapien asks for opencv-python, whose windows need libGL: the headless build must have won.
    info = run(python, "-c", "import cv2; print(cv2.getBuildInformation())", cwd=tmp_path)
    assert [line.split()[-1] for line in info.splitlines() if "GUI:" in line] == ["NONE"]
