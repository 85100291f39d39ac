"""Each command gives with many workers on a slow disk what it gives with one."""

import hashlib
import json
import os
import subprocess
import sys
from collections.abc import Sequence
from pathlib import Path

import pytest
from still_life import FEW

pytestmark = [pytest.mark.sim, pytest.mark.render, pytest.mark.slow]

SLOW_DISK = """import os, time
really = os.fsync
def fsync(file):
    time.sleep(0.1)
    really(file)
os.fsync = fsync
"""
COLLECT = "collect --out OUT --cameras head --size 32x32 --protocol phys_random"
COMMANDS = {
    "certify": "certify --task click_bell --protocol clean --feasible 4 --out OUT",
    "check": "check click_bell --seeds 4 --baselines 0 --json",
    "sensitivity": "sensitivity --task click_bell --only friction --seeds 2 --steps 1 --out OUT",
    "shard": f"{COLLECT} --task click_bell,lift_pot --episodes 3 --shard 1/4",
}
EVALUATE = "evaluate --task click_bell --protocol clean --episodes 3 --policy"


def run(line: str, out: Path, workers: int, more: Sequence[str] = ()) -> dict[str, object]:
    """What a command leaves in a new folder, files that say how long it took read without that."""
    out.mkdir()
    (out.parent / "sitecustomize.py").write_text(SLOW_DISK)
    slow = {"PYTHONPATH": os.pathsep.join([str(out.parent), *sys.path])} if workers > 1 else {}
    words = [*line.replace("OUT", str(out)).split(), *more]
    command = [sys.executable, "-m", "rtphys.cli.main", *words, "--workers", str(workers)]
    done = subprocess.run(command, env={**os.environ, **slow}, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr[-2000:]
    if "--json" in words:
        return {"stdout": json.loads(done.stdout, object_hook=_without_times)}
    return {
        path.relative_to(out).as_posix(): content(path)
        for path in sorted(out.rglob("*"))
        if path.is_file()
    }


def content(path: Path) -> object:
    if path.name.startswith("_result"):  # its first line says when
        lines = path.read_text().splitlines()
        return [line for line in lines if not line.startswith("Timestamp")]
    return hashlib.sha256(path.read_bytes()).hexdigest()


def _without_times(values: dict[str, object]) -> dict[str, object]:
    return {key: value for key, value in values.items() if "seconds" not in key}


@pytest.mark.parametrize("name", COMMANDS)
def test_many_workers_give_what_one_gives(name: str, tmp_path: Path) -> None:
    one, many = (run(COMMANDS[name], tmp_path / str(workers), workers) for workers in (1, 8))
    assert one and one == many


@pytest.fixture(scope="module")
def lists(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("certified")
    run(COMMANDS["certify"], folder / "lists", 2)
    return folder / "lists"


@pytest.mark.parametrize("policy", ["expert", f"{FEW} --policy-option look=yes"])
def test_an_evaluation_and_what_it_records(policy: str, lists: Path, tmp_path: Path) -> None:
    """`expert` and a plug-in in Python."""

    def evaluated(workers: int) -> dict[str, object]:
        out = tmp_path / str(workers)
        places = ["--instances", str(lists), "--out", str(out / "results")]
        return run(f"{EVALUATE} {policy}", out, workers, [*places, "--record", str(out / "data")])

    one = evaluated(1)
    assert any(name.endswith(".hdf5") for name in one)
    assert one == evaluated(8)
