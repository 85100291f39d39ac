"""What may be asked of cameras, and what is refused before any work."""

import pytest

from rtphys.core.errors import BadValue, RtphysError, UnknownName
from rtphys.senses import REDRAWN, SENSES, drawn
from rtphys.spec.recording import RecordingSpec, parse_size


@pytest.mark.parametrize(
    ("given", "words"),
    [
        ({"senses": ("detph",)}, "did you mean 'depth'"),
        ({"cameras": ("haed",)}, "did you mean 'head'"),
        ({"camera_type": "D345"}, "did you mean 'D435'"),
        ({"senses": ("depth", "depth")}, "name each sense once"),
        ({"cameras": ("head", "head_camera")}, "name each camera once"),
        ({"cameras": ("left",), "senses": ("pointcloud",)}, "head camera's"),
        ({"size": "640"}, "WIDTHxHEIGHT"),
        ({"size": "64000x48000"}, "16 to 2048"),
        ({"size": "8x8"}, "16 to 2048"),
        ({"size": "641x480"}, "even"),
        ({"size": "-640x480"}, "WIDTHxHEIGHT"),
    ],
)
def test_what_cannot_be_recorded_is_refused(given: dict[str, object], words: str) -> None:
    with pytest.raises(RtphysError, match=words) as caught:
        RecordingSpec(**given)  # type: ignore[arg-type]
    assert isinstance(caught.value, BadValue | UnknownName)


def test_a_type_gives_size_and_view_and_a_size_overrides_it() -> None:
    assert RecordingSpec().optics("L515") == (320, 180, 45.0)  # a camera's own
    assert RecordingSpec(camera_type="Large_D435").optics("L515") == (640, 480, 37.0)
    assert RecordingSpec(camera_type="L515", size="640x480").optics("D435") == (640, 480, 45.0)
    assert parse_size("2048x2048") == (2048, 2048)


def test_senses_are_counted_by_pixel_and_by_frame() -> None:
    assert RecordingSpec().frame_bytes() == 0
    three = RecordingSpec(senses=("depth", "segmentation")).frame_bytes()
    assert three == 3 * 320 * 240 * 14
    assert RecordingSpec(("head",), ("depth",), size="640x480").frame_bytes() == 640 * 480 * 8
    assert RecordingSpec(senses=("pointcloud",)).frame_bytes() == 1024 * 6 * 4


def test_only_what_cameras_see_needs_them() -> None:
    assert drawn(("states", "depth")) and not drawn(("states",)) and not drawn(())
    assert set(REDRAWN) <= set(SENSES) and "states" in REDRAWN


def test_a_task_may_need_a_camera_of_its_own() -> None:
    """Where none are named."""
    usual, named = RecordingSpec(), RecordingSpec(("left_camera", "head"))
    assert usual.of_task("place_phone_stand").cameras == ("head", "left", "right", "front")
    assert usual.of_task("click_bell").cameras == ("head", "left", "right")
    assert named.of_task("place_phone_stand").cameras == named.cameras == ("left", "head")
    assert (usual.official, named.official) == (
        ("head_camera", "left_camera", "right_camera"),
        ("left_camera", "head_camera"),
    )
