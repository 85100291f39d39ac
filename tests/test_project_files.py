"""The files that hosts and tools read: they parse, and speak of what exists."""

import ast
import importlib
import os
import re
import subprocess
import sys
import tomllib
from collections import Counter
from pathlib import Path

import pytest
import yaml

ROOT = Path(__file__).parents[1]
WORKFLOWS = sorted((ROOT / ".github" / "workflows").glob("*.yml"))
PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]

pytestmark = pytest.mark.skipif(not WORKFLOWS, reason="not a checkout")


@pytest.mark.parametrize("path", WORKFLOWS, ids=lambda path: path.stem)
def test_workflows_call_make_targets_that_exist(path: Path) -> None:
    targets = set(re.findall(r"^([\w-]+):", (ROOT / "Makefile").read_text(), re.MULTILINE))
    jobs = yaml.safe_load(path.read_text())["jobs"]
    commands = [step["run"] for job in jobs.values() for step in job["steps"] if "run" in step]
    called = {word for line in commands for word in re.findall(r"^make ([\w-]+)", line)}
    assert called and called <= targets


def test_every_supported_python_is_tested() -> None:
    jobs = yaml.safe_load((ROOT / ".github" / "workflows" / "ci.yml").read_text())["jobs"]
    versions = jobs["test"]["strategy"]["matrix"]["python"]
    assert versions == ["3.11", "3.12", "3.13"]
    minor = int(versions[-1].partition(".")[2])
    assert PROJECT["requires-python"] == f">={versions[0]},<3.{minor + 1}"


def test_the_certified_versions_are_above_the_floors() -> None:
    pinned = dict(
        line.split("==")
        for line in (ROOT / "manifests" / "constraints.txt").read_text().splitlines()
        if "==" in line and not line.startswith("#")
    )
    floors = dict(re.fullmatch(r"([\w.-]+)>=([\d.]+)", d).groups() for d in PROJECT["dependencies"])
    shared = pinned.keys() & floors.keys()
    assert {"numpy", "sapien", "pin", "h5py"} <= shared
    for name in shared:
        assert numbers(pinned[name]) >= numbers(floors[name]), name


def numbers(version: str) -> list[int]:
    return [int(part) for part in version.split(".")]


def test_the_set_up_takes_a_python_whose_path_has_a_space(tmp_path: Path) -> None:
    text = (ROOT / "scripts" / "setup.sh").read_text()
    found = re.search(r"^find_python\(\) \{.*?^\}", text, re.DOTALL | re.MULTILINE)
    assert found is not None
    (tmp_path / "my python").mkdir()
    (python := tmp_path / "my python" / "python").symlink_to(sys.executable)
    words, place = (
        ["bash", "-euc", f"{found[0]}\nfind_python"],
        {**os.environ, "PYTHON": str(python)},
    )
    done = subprocess.run(words, env=place, check=False, capture_output=True, text=True)
    assert (done.stdout.strip(), done.returncode) == (str(python), 0)


@pytest.mark.parametrize("name", ["CITATION.cff", ".pre-commit-config.yaml"])
def test_it_is_yaml(name: str) -> None:
    content = yaml.safe_load((ROOT / name).read_text())
    assert content.get("license", "Apache-2.0") == PROJECT["license"]


SCRIPTS = sorted(
    path
    for folder in ("benchmarks", "examples", "scripts")
    for path in (ROOT / folder).rglob("*.py")
)


def test_no_two_modules_of_tests_have_one_name() -> None:
    """pytest puts their folders on one path, and a whole run would stop at the second."""
    names = Counter(path.name for path in (ROOT / "tests").rglob("*.py"))
    del names["conftest.py"]  # which pytest tells apart
    assert not [name for name, count in names.items() if count > 1]


@pytest.mark.parametrize("path", SCRIPTS, ids=lambda path: path.relative_to(ROOT).as_posix())
def test_what_scripts_import_of_rtphys_is_there(path: Path) -> None:
    """No other check reads them: pyright stops at the package, tests and tasks."""
    for node in ast.walk(ast.parse(path.read_text())):
        if isinstance(node, ast.ImportFrom) and (node.module or "").startswith("rtphys"):
            module = importlib.import_module(str(node.module))
            for name in (alias.name for alias in node.names):
                if not hasattr(module, name):
                    importlib.import_module(f"{node.module}.{name}")


@pytest.mark.parametrize(
    "name",
    [
        "benchmarks/gpu.py",
        "benchmarks/verify.py",
        "scripts/feasibility.py",
        "scripts/pictures.py",
        "scripts/robots.py",
    ],
)
def test_what_simulates_or_verifies_in_its_own_process_asks_for_the_same_bits(name: str) -> None:
    """Numpy's code for AVX-512 gives others: to `verify`, every dataset was damaged there."""
    found = [
        alias.name if isinstance(node, ast.Import) else str(node.module)
        for node in ast.parse((ROOT / name).read_text()).body
        if isinstance(node, ast.Import | ast.ImportFrom)
        for alias in node.names
    ]
    before = found[: found.index("rtphys.core.pinned")]
    assert {one.partition(".")[0] for one in before} <= sys.stdlib_module_names
