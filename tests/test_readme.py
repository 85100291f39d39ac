"""README is short and true, as are the pages it leads to: tables are generated, commands exist."""

import os
import re
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

from rtphys.cli.lazy import COMMANDS

ROOT = Path(__file__).resolve().parents[1]
README = (ROOT / "README.md").read_text()


def test_tables_are_up_to_date() -> None:
    command = [sys.executable, "scripts/tables.py", "--check"]
    done = subprocess.run(command, cwd=ROOT, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr


def test_every_command_is_described() -> None:
    page = (ROOT / "docs" / "commands.md").read_text()
    described = set(re.findall(r"^\| `rtphys ([\w-]+)", page, re.MULTILINE))
    assert described == COMMANDS.keys()


def test_it_is_one_page() -> None:
    assert len(README.splitlines()) <= 120


def test_make_targets_exist() -> None:
    makefile = (ROOT / "Makefile").read_text()
    targets = set(re.findall(r"^([\w-]+):", makefile, re.MULTILINE))
    assert set(re.findall(r"\bmake ([a-z-]+)", README)) <= targets


@pytest.mark.skipif(shutil.which("make") is None, reason="make is missing")
def test_ci_runs_every_part_and_the_tests_of_the_readme_last() -> None:
    environment = {k: v for k, v in os.environ.items() if k not in ("MAKEFLAGS", "MAKELEVEL")}
    command = ["make", "--dry-run", "ci"]
    done = subprocess.run(command, cwd=ROOT, env=environment, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    for part in ("ruff format --check", "pyright", "tests/test_wheel.py", "verify"):
        assert part in done.stdout
    assert '-m pytest -n 2 --dist worksteal -m "not slow"' in done.stdout.splitlines()[-1]
    assert "make --no-print-directory ci" in (ROOT / ".ci" / "run").read_text()


def test_pictures_exist() -> None:
    missing = [p for p in re.findall(r"!\[[^]]*\]\(([^)]+)\)", README) if not (ROOT / p).is_file()]
    assert not missing
