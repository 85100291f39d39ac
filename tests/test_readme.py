"""README says what is true: its tables are the generated ones, its commands exist."""

import re
import subprocess
import sys
from pathlib import Path

from rtphys.cli.main import COMMANDS

ROOT = Path(__file__).resolve().parents[1]
README = (ROOT / "README.md").read_text()


def test_tables_are_up_to_date() -> None:
    command = [sys.executable, "scripts/tables.py", "--check"]
    done = subprocess.run(command, cwd=ROOT, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr


def test_every_command_is_described() -> None:
    described = set(re.findall(r"^\| `rtphys ([\w-]+)", README, re.MULTILINE))
    assert described == COMMANDS.keys()


def test_make_targets_exist() -> None:
    makefile = (ROOT / "Makefile").read_text()
    targets = set(re.findall(r"^([\w-]+):", makefile, re.MULTILINE))
    assert set(re.findall(r"\bmake ([a-z-]+)", README)) <= targets


def test_pictures_exist() -> None:
    missing = [p for p in re.findall(r"!\[[^]]*\]\(([^)]+)\)", README) if not (ROOT / p).is_file()]
    assert not missing
