"""Any number of workers, on a slow disk and a busy machine, gives what one worker gives."""

import signal
import subprocess
import sys
import time
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import pytest
from collecting import complete, content, worker_processes
from robotless import variants

from rtphys.campaign.pool import Limits
from rtphys.data.dataset import Dataset
from rtphys.data.verify import verify
from rtphys.spec.collection import CollectionSpec
from rtphys.spec.episode import EpisodeSpec
from rtphys.spec.recording import RecordingSpec
from rtphys.studies import collect as collect_module
from rtphys.studies.collect import collect
from rtphys.studies.render import render
from rtphys.studies.requests import RenderSpec, Run, specs_for

pytestmark = [pytest.mark.sim, pytest.mark.render, pytest.mark.processes, pytest.mark.slow]

TASKS = ("click_bell", "dump_bin_bigbin", "lift_pot")
REAL = tuple(
    CollectionSpec(
        EpisodeSpec(task, "clean"), episodes=3, recording=RecordingSpec(("head",), size="32x32")
    )
    for task in TASKS
)
SLOW_DISK = """import os, time
really = os.fsync
def fsync(file):
    time.sleep(0.3)
    really(file)
os.fsync = fsync
"""


@pytest.fixture(scope="module", params=[*variants(REAL), "sweep"])
def specs(request: pytest.FixtureRequest) -> Sequence[CollectionSpec]:
    if request.param == "sweep":
        return specs_for(replace(REAL[0], episodes=2), TASKS[:2], "friction=0.1,0.5")
    return variants(REAL)[request.param]


@pytest.fixture(scope="module")
def alone(specs: Sequence[CollectionSpec], tmp_path_factory: pytest.TempPathFactory) -> Path:
    """By one worker."""
    out = tmp_path_factory.mktemp("alone") / "data"
    assert complete(collect(specs, Run(out, workers=1)))
    return out


@pytest.mark.parametrize(("workers", "slow"), [(8, True), (24, False)])
def test_many_real_workers_give_what_one_gives(
    specs: Sequence[CollectionSpec],
    alone: Path,
    workers: int,
    slow: bool,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """Also if an attempt may take no more than 25 s, of which many workers leave it few."""
    if slow:
        (tmp_path / "sitecustomize.py").write_text(SLOW_DISK)
        monkeypatch.syspath_prepend(str(tmp_path))
    monkeypatch.setattr(collect_module, "LIMITS", Limits(seconds=25))
    run = Run(tmp_path / "data", workers=workers)
    assert complete(collect(specs, run))
    assert content(run.out) == content(alone)


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM, signal.SIGHUP])
def test_a_signal_ends_all_workers_at_once(number: signal.Signals, tmp_path: Path) -> None:
    options = f"--task {','.join(TASKS)} --episodes 50 --size 32x32 --workers 16 --out {tmp_path}"
    command = [sys.executable, "-m", "rtphys.cli.main", "collect", *options.split()]
    heard = signal.signal(number, signal.SIG_DFL)  # under `nohup` the child would ignore it as well
    running = subprocess.Popen(command, stderr=subprocess.PIPE, text=True)
    signal.signal(number, heard)
    try:
        manifest = tmp_path / "manifest.json"
        while len(begun := worker_processes(running.pid)) < 16 or not manifest.exists():
            time.sleep(0.1)
        running.send_signal(number)
        _, said = running.communicate(timeout=20)
    finally:
        running.kill()
    assert running.returncode == 130
    assert "To go on, repeat: rtphys collect" in said.splitlines()[-1]
    assert not {*begun}.intersection(worker_processes(1))
    assert not [*tmp_path.rglob(".staging")]
    assert "Traceback" not in said and verify(tmp_path).problems == []


def test_many_workers_draw_again_what_one_draws(alone: Path, tmp_path: Path) -> None:
    for workers in (1, 8):
        render(RenderSpec(alone, tmp_path / str(workers), look="clean", workers=workers))
    assert len(Dataset(tmp_path / "8"))
    assert content(tmp_path / "8") == content(tmp_path / "1")
