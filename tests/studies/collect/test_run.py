"""A collection that is killed, resumed or repeated: the same files, and what they hold."""

import shutil
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from collecting import PLAN, Striker, complete, content, kill_one, worker_processes
from killing import survive

from rtphys.assets.pack import default_pack
from rtphys.core.poses import Pose
from rtphys.data.check_episode import Effort
from rtphys.data.dataset import Dataset
from rtphys.data.verify import verify
from rtphys.episode.assemble import assemble
from rtphys.episode.generate import attempt
from rtphys.physics.attributes.friction import Friction
from rtphys.physics.enforce import FalseLabel
from rtphys.spec.episode import EpisodeSpec
from rtphys.studies.collect import collect
from rtphys.studies.requests import Run
from rtphys.task.spec import load_task

pytestmark = [pytest.mark.sim, pytest.mark.render]


@pytest.mark.processes
def test_two_workers_one_of_them_killed_give_the_same_files(
    undisturbed: Path, tmp_path: Path
) -> None:
    # Later it may be one with nothing left to do, whom nobody misses.
    striker = Striker(lambda: kill_one(worker_processes()), early=True)
    assert complete(collect([PLAN], Run(tmp_path / "data", workers=2), striker))
    assert striker.struck and len(striker.told) == 1
    assert content(tmp_path / "data") == content(undisturbed)


def test_a_resumed_run_gives_the_same_files(undisturbed: Path, tmp_path: Path) -> None:
    out = tmp_path / "data"
    assert complete(collect([replace(PLAN, episodes=1)], Run(out, workers=1)))
    assert len(Dataset(out)) == 1
    progresses = collect([PLAN], Run(out, workers=2))
    assert progresses[0].accepted - progresses[0].new_accepted == 1
    assert content(out) == content(undisturbed)


def test_a_complete_dataset_is_left_alone(undisturbed: Path, tmp_path: Path) -> None:
    out = tmp_path / "data"
    shutil.copytree(undisturbed, out)
    progresses = collect([PLAN], Run(out, workers=1))
    assert progresses[0].new_attempts == 0
    assert content(out) == content(undisturbed)


@pytest.mark.processes
@pytest.mark.slow
def test_killed_runs_end_in_the_same_files(tmp_path: Path) -> None:
    """`python tests/studies/collect/killing.py 200` does it two hundred times."""
    count = survive(8, tmp_path, seed=1)
    assert count.kills["supervisor"] > 0 and count.kills["worker"] > 0


def test_the_dataset_proves_itself(undisturbed: Path) -> None:
    report = verify(undisturbed, Effort.DEEP)  # also that a wrist camera is rigid to its hand
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
    assert head.shape[1:] == (120, 160, 3)
    assert head[0].std() > 10, "the picture shows something"
    assert set(episode.cameras) == {"head_camera", "left_camera", "right_camera"}
    assert np.abs(head[0].astype(int) - head[-1].astype(int)).max() > 50, "the arm has moved"


def test_a_wrist_camera_is_rigid_to_its_hand(undisturbed: Path) -> None:
    """Order of quaternions, frames and times in one: the camera never moves in the ee frame."""
    frames = Dataset(undisturbed)[0].frames
    for side in ("left", "right"):
        camera = frames.cameras[f"{side}_camera"].cam2world_gl
        hand = getattr(frames, f"{side}_endpose")
        seen = [np.linalg.inv(matrix(pose)) @ X for pose, X in zip(hand, camera, strict=True)]
        assert np.ptp(np.array(seen), axis=0).max() < 1e-4


def matrix(pose: np.ndarray) -> np.ndarray:
    return Pose(pose[:3], pose[3:]).matrix


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


def test_a_false_label_is_an_error_not_an_episode() -> None:
    task, pack = load_task("click_bell"), default_pack()
    tried = attempt(EpisodeSpec("click_bell", "phys_random").at(0), task, pack)
    assert tried.instance is not None
    assemble(tried, pack)
    for surface in tried.instance.world.surfaces:
        surface.set_material(0.123, 0.123, 0.0)
    with pytest.raises(FalseLabel, match=r"click_bell, seed 0: .*friction"):
        assemble(tried, pack)


def test_no_attempt_is_made_where_an_attribute_is_not_what_it_was_set_to(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """Lists and evaluations have no label that would be compared with the world at the end."""
    monkeypatch.setattr(Friction, "apply", lambda self, target, value: None)
    with pytest.raises(FalseLabel, match=r"click_bell, seed 0: friction at bell"):
        attempt(
            EpisodeSpec("click_bell", "phys_random").at(0), load_task("click_bell"), default_pack()
        )


def test_an_attempt_in_which_nothing_happened_is_no_episode() -> None:
    task, pack = load_task("click_bell"), default_pack()
    tried = attempt(EpisodeSpec("click_bell", "clean").at(0), task, pack)
    assert tried.instance is not None
    rejected = replace(tried, reason="slipped", recording=None)
    with pytest.raises(ValueError, match="slipped"):
        assemble(rejected, pack)
