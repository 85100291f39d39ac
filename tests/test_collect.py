"""Collecting click_bell for real: what is written, resumed, killed, refused."""

import hashlib
import json
import os
import shutil
import signal
import subprocess
import sys
import time
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from typer.testing import CliRunner

import rtphys.collect.plan as plan_module
from rtphys.assemble import FalseLabel, assemble
from rtphys.assets.pack import default_pack
from rtphys.cli.main import app
from rtphys.collect import CollectPlan, Listener, collect
from rtphys.collect.run import Bug
from rtphys.data.faults import DatasetMismatch
from rtphys.dataset import Dataset
from rtphys.doctor import Finding
from rtphys.generate import attempt
from rtphys.photograph import Photographs
from rtphys.recipe import Recipe
from rtphys.task.spec import load_task
from rtphys.verify import verify

pytestmark = [pytest.mark.sim, pytest.mark.render]

PLAN = CollectPlan(("click_bell",), 2, Path(), protocol="phys_random")


@pytest.fixture(scope="module")
def undisturbed(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Two episodes by one worker."""
    out = tmp_path_factory.mktemp("undisturbed") / "data"
    summary = collect(replace(PLAN, out=out))
    assert summary.complete
    return out


def content(out: Path) -> dict[str, str]:
    """Path -> SHA-256 of every file, journals and manifest included."""
    files = (path for path in out.rglob("*") if path.is_file())
    return {
        path.relative_to(out).as_posix(): hashlib.sha256(path.read_bytes()).hexdigest()
        for path in files
    }


def children(pid: int) -> list[int]:
    """Worker processes of a process."""
    found = []
    for task in Path(f"/proc/{pid}/task").iterdir():
        found += [int(child) for child in (task / "children").read_text().split()]
    return found


# ---- what is written -----------------------------------------------------------------------------


def test_the_dataset_proves_itself(undisturbed: Path) -> None:
    report = verify(undisturbed)
    assert [str(problem) for problem in report.problems] == []
    assert report.notes == []
    assert report.episodes == 2


def test_an_episode_holds_what_happened(undisturbed: Path) -> None:
    episode = Dataset(undisturbed)[0]
    frames = episode.frames
    assert np.allclose(np.diff(frames.time), 0.06)
    assert frames.stages[0] == "start"
    assert frames.stages[-1] == "hold"
    assert frames.contacts["bell"].any(), "a finger touched the bell"
    head = episode.images("head_camera")
    assert head.shape[1:] == (240, 320, 3)
    assert head[0].std() > 10, "the picture shows something"
    assert set(episode.cameras) == {"head_camera", "left_camera", "right_camera"}
    assert np.abs(head[0].astype(int) - head[-1].astype(int)).max() > 50, "the arm has moved"


def test_a_label_tells_what_was_in_force(undisturbed: Path) -> None:
    meta = Dataset(undisturbed)[0].meta
    assert len(meta.attributes) == 13
    friction = meta.attributes["friction"]
    assert friction.varied
    bell = meta.readback.surfaces["bell"]
    assert bell["static_friction"] == pytest.approx(friction.value, rel=1e-6)
    height = meta.attributes["table_height"].value
    assert meta.readback.table["height"] == pytest.approx(height, abs=1e-6)  # [m] single precision
    assert meta.verdict.first_success_time is not None
    assert meta.versions["sapien"]
    assert len(meta.state_hash) == 64


def test_the_sentences_name_the_bell_and_the_arm(undisturbed: Path) -> None:
    episode = Dataset(undisturbed)[0]
    sentences = episode.instructions.seen
    assert len(sentences) >= 20
    assert any("bell" in sentence for sentence in sentences)
    side = "left" if episode.frames.object_poses["bell"][0, 0] < 0 else "right"
    assert any(f"the {side} arm" in sentence for sentence in sentences)


def test_a_wrist_camera_is_rigid_to_its_hand(undisturbed: Path) -> None:
    """Order of quaternions, frames and times in one: the camera never moves in the ee frame."""
    frames = Dataset(undisturbed)[0].frames
    for side in ("left", "right"):
        camera = frames.cameras[f"{side}_camera"].cam2world_gl
        hand = getattr(frames, f"{side}_endpose")
        seen = [np.linalg.inv(matrix(pose)) @ X for pose, X in zip(hand, camera, strict=True)]
        assert np.ptp(np.array(seen), axis=0).max() < 1e-4


def matrix(pose: np.ndarray) -> np.ndarray:
    from rtphys.poses import Pose

    return Pose(pose[:3], pose[3:]).matrix


# ---- the same whatever happens -------------------------------------------------------------------


class Killer(Listener):
    """Kills one worker at the given tick."""

    def __init__(self, tick: int) -> None:
        self.left = tick
        self.killed = 0
        self.deaths: list[str] = []

    def ticked(self) -> None:
        self.left -= 1
        workers = children(os.getpid())
        if self.left <= 0 and workers and not self.killed:
            self.killed = workers[0]
            os.kill(workers[0], signal.SIGKILL)

    def noticed(self, text: str) -> None:
        self.deaths.append(text)


def test_two_workers_one_of_them_killed_give_the_same_files(
    undisturbed: Path, tmp_path: Path
) -> None:
    killer = Killer(tick=3)
    summary = collect(replace(PLAN, out=tmp_path / "data", workers=2), killer)
    assert summary.complete
    assert killer.killed
    assert len(killer.deaths) == 1
    assert content(tmp_path / "data") == content(undisturbed)


def test_a_resumed_run_gives_the_same_files(undisturbed: Path, tmp_path: Path) -> None:
    out = tmp_path / "data"
    assert collect(replace(PLAN, out=out, episodes=1)).complete
    assert len(Dataset(out)) == 1
    summary = collect(replace(PLAN, out=out, episodes=2, workers=2))
    assert summary.tallies[0].found_episodes == 1
    assert content(out) == content(undisturbed)


def test_a_complete_dataset_is_left_alone(undisturbed: Path, tmp_path: Path) -> None:
    out = tmp_path / "data"
    shutil.copytree(undisturbed, out)
    summary = collect(replace(PLAN, out=out))
    assert summary.tallies[0].new_attempts == 0
    assert content(out) == content(undisturbed)


COMMAND = ["--task", "click_bell", "--episodes", "2", "--protocol", "phys_random", "--workers", "2"]


@pytest.mark.slow
@pytest.mark.parametrize("after", [1.5, 3.0, 4.5, 6.0, 7.5])
def test_a_killed_supervisor_is_resumed(undisturbed: Path, tmp_path: Path, after: float) -> None:
    out = tmp_path / "data"
    command = [sys.executable, "-m", "rtphys.cli.main", "collect", *COMMAND, "--out", str(out)]
    first = subprocess.Popen(command, stderr=subprocess.DEVNULL, stdout=subprocess.DEVNULL)
    time.sleep(after)
    first.kill()
    first.wait()
    done = subprocess.run(command, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    assert content(out) == content(undisturbed)


@pytest.mark.slow
def test_ctrl_c_stops_cleanly_and_says_how_to_go_on(undisturbed: Path, tmp_path: Path) -> None:
    out = tmp_path / "data"
    command = [sys.executable, "-m", "rtphys.cli.main", "collect", *COMMAND, "--out", str(out)]
    running = subprocess.Popen(command, stderr=subprocess.PIPE, text=True)
    while not (out / "phys_random").exists():
        time.sleep(0.1)
    time.sleep(2)
    running.send_signal(signal.SIGINT)
    _, said = running.communicate(timeout=20)
    assert running.returncode == 130
    assert "To go on, repeat: rtphys collect" in said.splitlines()[-1]
    assert "Traceback" not in said
    assert verify(out).problems == []


# ---- what is refused -----------------------------------------------------------------------------

WRONG = {
    "--task click_bel": "did you mean 'click_bell'?",
    "--task click_bell --protocol cleen": "did you mean 'clean'?",
    "--task click_bell --cameras head,lft": "did you mean 'left'?",
    "--task click_bell --cameras left": "head is needed",
    "--task click_bell --cameras head,head": "each camera once",
    "--task click_bell --layout nativ": "did you mean 'native'?",
    "--task click_bell --shader slm": "did you mean 'slim'?",
    "--task click_bell --set frction=1": "did you mean 'friction'?",
    "--task click_bell --set friction=-1": "friction = -1.0 is not allowed",
    "--task click_bell --set friction": "write key=value",
    "--task click_bell --only friction": "varies no physics",
    "--task click_bell --protocol phys_random --only friktion": "did you mean 'friction'?",
    "--task click_bell --episodes 0": "--episodes = 0 is not allowed",
    "--task click_bell --workers 0": "--workers = 0 is not allowed",
    "--task click_bell --seed -1": "--first-seed = -1 is not allowed",
    "--task click_bell --episodes 100000000": "GB are needed",
}


@pytest.mark.parametrize("options", WRONG)
def test_what_cannot_work_is_one_clear_line_and_no_file(options: str, tmp_path: Path) -> None:
    out = tmp_path / "data"
    done = CliRunner().invoke(app, ["collect", *options.split(), "--out", str(out)])
    assert done.exit_code == 2
    assert len(done.stderr.strip().splitlines()) == 1
    assert WRONG[options] in done.stderr
    assert not out.exists()


def test_a_file_in_the_way_is_refused(tmp_path: Path) -> None:
    (tmp_path / "file").touch()
    out = tmp_path / "file" / "data"
    done = CliRunner().invoke(app, ["collect", "--task", "click_bell", "--out", str(out)])
    assert done.exit_code == 2
    assert str(out) in done.stderr


def test_without_a_renderer_the_cure_is_named(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    broken = Finding("renderer", "fail", "no_driver", "the Vulkan loader finds no device")
    monkeypatch.setattr(plan_module, "check_renderer", lambda command: broken)
    out = tmp_path / "data"
    done = CliRunner().invoke(app, ["collect", "--task", "click_bell", "--out", str(out)])
    assert done.exit_code == 3
    assert "mesa-vulkan-drivers" in done.stderr
    assert not out.exists()


def test_a_folder_collected_under_other_conditions_is_refused(
    undisturbed: Path, tmp_path: Path
) -> None:
    out = tmp_path / "data"
    shutil.copytree(undisturbed, out)
    with pytest.raises(DatasetMismatch, match="first_seed was 0, now 1"):
        collect(replace(PLAN, out=out, first_seed=1))
    assert content(out) == content(undisturbed)


# ---- tasks that do not work ----------------------------------------------------------------------

HOPELESS = '''
"""Do what cannot be done."""
from dataclasses import replace
from rtphys.task import Infeasible, load_task

def script(robot):
    {script}

task = replace(load_task("click_bell"), script=script)
'''


@pytest.fixture
def make_task(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[object]:
    """Adds a library with one task, whose script is given."""

    def make(script: str) -> None:
        (tmp_path / "own" / "tasks").mkdir(parents=True)
        (tmp_path / "own" / "tasks" / "hopeless.py").write_text(HOPELESS.format(script=script))
        monkeypatch.setenv("RTPHYS_LIBRARY", str(tmp_path / "own"))

    return make


def test_a_hopeless_task_is_given_up_and_its_rejections_are_kept(make_task, tmp_path: Path) -> None:
    make_task('raise Infeasible("unreachable", "for all eternity")')
    out = tmp_path / "data"
    options = ["--task", "hopeless", "--out", str(out), "--max-attempts", "3", "--workers", "1"]
    done = CliRunner().invoke(app, ["collect", *options])
    assert done.exit_code == 4
    assert "hopeless: 3 attempts were made" in done.stderr
    assert verify(out).problems == []
    leaf = json.loads((out / "manifest.json").read_text())["leaves"]["clean/hopeless/aloha_agilex"]
    assert leaf["rejections"] == {"unreachable": 3}
    assert leaf["episodes"] == 0


def test_a_bug_in_a_script_stops_the_run_with_a_traceback_in_a_file(
    make_task, tmp_path: Path
) -> None:
    make_task("robot.dance()")
    out = tmp_path / "data"
    with pytest.raises(Bug, match=r"hopeless, seed 0: AttributeError: .*dance") as caught:
        collect(CollectPlan(("hopeless",), 1, out))
    log = out / "error.log"
    assert str(log) in str(caught.value)
    assert "robot.dance()" in log.read_text()
    assert not list(out.rglob("*.hdf5"))


def test_a_false_label_is_an_error_not_an_episode() -> None:
    task, pack = load_task("click_bell"), default_pack()
    tried = attempt(Recipe("click_bell", 0, "phys_random"), task, pack)
    assert tried.instance is not None
    nothing = Photographs({}, {}, iter(()))
    assemble(tried, nothing, pack)
    for surface in tried.instance.world.surfaces:
        surface.set_material(0.123, 0.123, 0.0)
    with pytest.raises(FalseLabel, match=r"click_bell, seed 0: .*friction"):
        assemble(tried, nothing, pack)


def test_a_rejected_attempt_is_no_episode() -> None:
    task, pack = load_task("click_bell"), default_pack()
    tried = attempt(Recipe("click_bell", 0), task, pack)
    rejected = replace(tried, reason="slipped")
    with pytest.raises(ValueError, match="slipped"):
        assemble(rejected, Photographs({}, {}, iter(())), pack)
