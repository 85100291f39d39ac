"""A sense that nobody knew: its one class is enough to write, read, verify and observe it."""

from pathlib import Path

import h5py
import numpy as np
import pytest

from rtphys.data.episode import Sensed
from rtphys.data.hdf5_file import GROUP, build
from rtphys.data.hdf5_senses import read_senses, sense_streams, write_senses
from rtphys.senses import SENSES, Field, Sense
from rtphys.senses.sense import Array, Arrays, Pixels
from rtphys.senses.touch import Touch
from rtphys.spec.recording import RecordingSpec

CAMERAS = ["head_camera", "left_camera"]
T, H, W = 4, 6, 8


class Brightness(Sense):
    """How bright each pixel is."""

    name = "brightness"
    scope = "pixel"
    size = 4
    fields = (
        Field(
            "brightness",
            ("observation/{camera}/brightness", "vision/{view}/brightness"),
            np.float32,
            ("H", "W"),
            low=0,
            high=255,
        ),
    )

    def capture(self, source: Pixels) -> Arrays:
        return {"brightness": source.rgb.mean(axis=2, dtype=np.float32)}

    def problem(self, frames: Array) -> str:
        return "is dark everywhere" if frames.max() == 0 else ""


@pytest.fixture
def brightness(monkeypatch: pytest.MonkeyPatch) -> Brightness:
    sense = Brightness()
    monkeypatch.setitem(SENSES, "brightness", sense)
    return sense


@pytest.mark.parametrize("layout", ["legacy", "native"])
def test_one_class_is_written_read_and_verified(
    brightness: Brightness, layout: str, tmp_path: Path
) -> None:
    rng, made = np.random.default_rng(0), Sensed(("brightness",))
    for _ in range(T):
        for camera in CAMERAS:
            frame = rng.random((H, W), np.float32) * 255
            made.keep(camera, {"brightness": frame})

    def fill(file: h5py.File) -> None:
        file.create_group(GROUP)
        write_senses(file, made, layout)

    path = tmp_path / "sensed.hdf5"
    path.write_bytes(build(fill))
    with h5py.File(path) as file:
        found = read_senses(file, layout, CAMERAS)
        assert found is not None and found.senses == ("brightness",)
        for place, frames in made.tracks.items():
            assert np.array_equal(found.tracks[place], frames)
        for stream in sense_streams(["brightness"], layout, CAMERAS):
            assert [*stream.problems(file, {"H": H, "W": W}, T, range(T))] == []
            (problem,) = stream.problems(file, {"H": H, "W": W + 1}, T, range(T))
            assert problem.endswith(f"not float32 {(T - (layout == 'native'), H, W + 1)}")


class Grip(Sense):
    """How hard each finger presses: of what the fingers feel."""

    name = "grip"
    scope = "world"
    size = 16
    fields = (Field("grip", ("rtphys/grip", "rtphys/grip"), np.float32, ("finger",), packed=False),)

    def capture(self, source: Touch) -> Arrays:
        return {"grip": source.normal_peak}


def test_a_sense_that_cameras_do_not_draw_turns_on_what_it_needs(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setitem(SENSES, "grip", Grip())
    assert RecordingSpec(senses=("grip",)).touch and not RecordingSpec(senses=("states",)).touch


def test_one_class_is_observed(brightness: Brightness) -> None:
    pytest.importorskip("gymnasium")
    from rtphys.gym.shapes import sensed

    spec = RecordingSpec(("head", "left"), ("brightness",))
    space = sensed(spec)["brightness"]
    assert set(space.spaces) == {"head", "left"}
    assert space["head"].shape == (240, 320) and space["head"].dtype == np.float32
    assert brightness.drawn
