"""`rtphys view`: the recording holds the episode, and the robot stands where it stood."""

import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from typer.testing import CliRunner

from rtphys.assets.pack import default_pack
from rtphys.cli.main import app
from rtphys.data.dataset import Dataset
from rtphys.episode.solids import solids
from rtphys.spec.collection import CollectionSpec
from rtphys.spec.episode import EpisodeSpec
from rtphys.spec.recording import RecordingSpec
from rtphys.studies.collect import collect
from rtphys.studies.requests import Run

pytestmark = [pytest.mark.sim, pytest.mark.render, pytest.mark.slow]
RERUN = Path(sys.executable).with_name("rerun")


@pytest.fixture(scope="module")
def data(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Its first attempt drops the phone, its second succeeds."""
    out = tmp_path_factory.mktemp("data")
    spec = EpisodeSpec("place_phone_stand", "phys_random_all")
    recording = RecordingSpec(("head",), ("touch",))
    plan = CollectionSpec(spec, recording, episodes=1, first_seed=71, keep_failures="all")
    collect([plan], Run(out, workers=1))
    return out


def test_the_robot_and_the_objects_stand_where_the_files_say(data: Path) -> None:
    (episode,) = Dataset(data)
    found = {solid.name: solid for solid in solids(episode, default_pack())}
    for side, link in (("left", "fl_link6"), ("right", "fr_link6")):
        stored = getattr(episode.frames, f"{side}_endpose")
        assert np.abs(found[f"robot/{link}"].poses[:, :3] - stored[:, :3]).max() < 1e-4
    phone = found["objects/phone"]
    assert np.allclose(phone.poses, episode.frames.object_poses["phone"], atol=1e-6)
    size = np.ptp(phone.vertices, axis=0)
    assert 0.005 < size.min() < 0.03 and 0.1 < size.max() < 0.25, "a phone's size in metres"
    # Every triangle is seen from outside: the volume they enclose is positive.
    a, b, c = (phone.vertices[phone.triangles[:, k]].astype(float) for k in range(3))
    assert np.einsum("ij,ij->i", a, np.cross(b, c)).sum() > 0
    assert len(found["room/table"].poses) == 1


@pytest.mark.parametrize("which", [[], ["--failure", "0"]])
def test_the_recording_is_sound_and_holds_it_all(
    data: Path, tmp_path: Path, which: list[str]
) -> None:
    pytest.importorskip("rerun")
    out = tmp_path / "episode.rrd"
    result = CliRunner().invoke(app, ["view", str(data), *which, "--out", str(out)])
    assert result.exit_code == 0, result.output
    verified = subprocess.run([RERUN, "rrd", "verify", out], capture_output=True, text=True)
    assert verified.returncode == 0, verified.stderr
    printed = subprocess.run([RERUN, "rrd", "print", out], capture_output=True, text=True).stdout
    places = ["/world/robot/fl_link6", "/world/objects/phone", "/cameras/head_camera"]
    places += ["/joints/left/1/command", "/forces/fl_link7", "/events", "/label"]
    places += ["/world/went_wrong"] if which else []
    missing = [place for place in places if place not in printed]
    assert not missing
    assert which or "/world/went_wrong" not in printed


@pytest.mark.parametrize(
    ("words", "told"),
    [
        (["--episode", "5"], "the dataset holds episodes 0 to 0"),
        (["--failure", "9"], "the dataset holds failures 0 to"),
        (["--out", "episode.mp4"], "its name ends in .rrd"),
    ],
)
def test_bad_input_is_refused(data: Path, words: list[str], told: str) -> None:
    result = CliRunner().invoke(app, ["view", str(data), *words])
    assert result.exit_code != 0 and told in f"{result.output}{result.exception}"
