"""Files of both layouts against the official specifications, and from one to the other and back."""

import fcntl
import io
import json
from pathlib import Path

import av
import cv2
import h5py
import numpy as np
import pytest
import simplejpeg
import synthetic
from PIL import Image

from rtphys.data import jpeg
from rtphys.data.hdf5_episode import (
    EpisodeFile,
    derived,
    episode_bytes,
    read_frames,
    read_pictures,
)
from rtphys.data.video import encode_images

T = 8
R = T - 1
SEEN = ["ring the bell", "läute die Glocke"]
LAYOUTS = ("native", "legacy")


@pytest.fixture(scope="module", params=LAYOUTS)
def layout(request: pytest.FixtureRequest) -> str:
    return request.param


@pytest.fixture(scope="module")
def made(layout):
    return synthetic.frames_of(3, T), encode_images(synthetic.pictures(3, T), layout)


@pytest.fixture(scope="module")
def file(layout, made, tmp_path_factory: pytest.TempPathFactory):
    path = tmp_path_factory.mktemp(layout) / "episode.hdf5"
    path.write_bytes(episode_bytes(layout, *made, SEEN))
    with h5py.File(path) as opened:
        yield opened


def test_reading_takes_no_lock(tmp_path: Path, layout, made) -> None:
    """Which would be refused where the file system has none, and here."""
    path = tmp_path / "episode.hdf5"
    path.write_bytes(episode_bytes(layout, *made, SEEN))
    with path.open("rb") as other:
        fcntl.flock(other, fcntl.LOCK_EX | fcntl.LOCK_NB)
        assert len(EpisodeFile(path, layout).frames()) == T


native = pytest.mark.parametrize("layout", ["native"], indirect=True)
legacy = pytest.mark.parametrize("layout", ["legacy"], indirect=True)

NATIVE = {
    **{
        f"{part}/{arm}_{key}": ((R, *columns), np.float32)
        for part in ("state", "action")
        for arm in ("left", "right")
        for key, columns in (
            ("arm_joint_states", (6,)),
            ("ee_joint_states", (1,)),
            ("ee_poses", (7,)),
        )
    },
    **{
        f"vision/{camera}/{key}": (shape, dtype)
        for camera in ("cam_head", "cam_left_wrist", "cam_right_wrist")
        for key, shape, dtype in (
            ("shape", (3,), np.int32),
            ("intrinsic_matrix", (R, 3, 3), np.float32),
            ("extrinsics_matrix", (R, 4, 4), np.float32),
        )
    },
    "additional_info/frequency": ((), np.int32),
}
LEGACY = {
    "joint_action/left_arm": ((T, 6), np.float64),
    "joint_action/left_gripper": ((T,), np.float64),
    "joint_action/right_arm": ((T, 6), np.float64),
    "joint_action/right_gripper": ((T,), np.float64),
    "joint_action/vector": ((T, 14), np.float64),
    "endpose/left_endpose": ((T, 7), np.float64),
    "endpose/left_gripper": ((T,), np.float64),
    "endpose/right_endpose": ((T, 7), np.float64),
    "endpose/right_gripper": ((T,), np.float64),
    "pointcloud": ((T, 0), np.float64),
    "observation/head_camera/intrinsic_cv": ((T, 3, 3), np.float32),
    "observation/left_camera/extrinsic_cv": ((T, 3, 4), np.float32),
    "observation/right_camera/cam2world_gl": ((T, 4, 4), np.float32),
}


def test_official_keys(file: h5py.File, layout: str) -> None:
    for key, (shape, dtype) in (NATIVE if layout == "native" else LEGACY).items():
        assert (file[key].shape, file[key].dtype) == (shape, dtype), key
        assert file[key].chunks is None, "contiguous, as official files are"


@native
def test_text_is_scalar_utf8(file: h5py.File) -> None:
    for key in ("data_format_version", "instruction", "instructions"):
        assert file[key].shape == ()
        assert h5py.check_string_dtype(file[key].dtype).encoding == "utf-8"
        assert h5py.check_string_dtype(file[key].dtype).length is None
    assert file["data_format_version"][()].decode() == "v1.0"
    assert file["instruction"][()].decode() == "ring the bell"
    assert json.loads(file["instructions"][()]) == SEEN
    assert file.attrs["source_format"] == "RoboTwin"
    assert file.attrs["source_path"] == "native_collection"
    assert file["additional_info/frequency"][()] == 15


@native
def test_action_is_the_next_state(file: h5py.File, made) -> None:
    frames, _ = made
    for arm in ("left", "right"):
        state = file[f"state/{arm}_arm_joint_states"][()]
        action = file[f"action/{arm}_arm_joint_states"][()]
        np.testing.assert_array_equal(action[:-1], state[1:])
        last = np.float32(getattr(frames, f"{arm}_arm")[-1])
        np.testing.assert_array_equal(action[-1], last)


@legacy
def test_vector_is_left_then_right(file: h5py.File) -> None:
    action = file["joint_action"]
    expected = np.column_stack(
        [action["left_arm"], action["left_gripper"], action["right_arm"], action["right_gripper"]]
    )
    np.testing.assert_array_equal(action["vector"], expected)
    np.testing.assert_array_equal(file["endpose/left_gripper"], action["left_gripper"])


@legacy
def test_official_part_has_no_attributes(file: h5py.File) -> None:
    assert not file.attrs
    named: list[str] = []
    file.visititems(lambda name, node: named.append(name) if node.attrs else None)
    assert all(name.startswith("rtphys") for name in named)


def test_pictures_are_fixed_length_and_nul_padded(file: h5py.File, made, layout: str) -> None:
    _, images = made
    for ours, theirs in (("head_camera", "cam_head"), ("left_camera", "cam_left_wrist")):
        whole = layout == "legacy"
        colors = file[f"observation/{ours}/rgb" if whole else f"vision/{theirs}/colors"]
        streams = images.jpegs[ours] if whole else images.jpegs[ours][:-1]
        assert colors.dtype.kind == "S"
        assert colors.dtype.itemsize == max(map(len, streams))
        assert list(colors[()]) == streams
        if not whole:
            expected = (synthetic.HEIGHT, synthetic.WIDTH, 3)
            assert tuple(file[f"vision/{theirs}/shape"]) == expected


def _by_pillow(stream: bytes) -> np.ndarray:
    return np.asarray(Image.open(io.BytesIO(stream)))


def _by_opencv(stream: bytes) -> np.ndarray:
    return cv2.imdecode(np.frombuffer(stream, np.uint8), cv2.IMREAD_COLOR)[..., ::-1]


def _by_pyav(stream: bytes) -> np.ndarray:
    """The decoder of ffmpeg's library, without the program."""
    with av.open(io.BytesIO(stream), format="jpeg_pipe") as container:
        return next(container.decode(video=0)).to_ndarray(format="rgb24")


DECODERS = {
    "Pillow": _by_pillow,
    "OpenCV": _by_opencv,
    "simplejpeg": simplejpeg.decode_jpeg,
    "PyAV": _by_pyav,
}


def _first_picture(file: h5py.File, layout: str) -> bytes:
    return file["vision/cam_head/colors" if layout == "native" else "observation/head_camera/rgb"][
        0
    ]


@pytest.mark.parametrize("decoder", DECODERS)
def test_what_others_see_of_both_generations(file: h5py.File, layout: str, decoder: str) -> None:
    """True colours of what is marked, red as blue of legacy files: a program that wants RGB."""
    stream = _first_picture(file, layout)
    seen = DECODERS[decoder](stream)
    assert seen.shape == (synthetic.HEIGHT, synthetic.WIDTH, 3)
    if layout == "legacy":
        seen = seen[..., ::-1]
    red, blue = seen[-4, 4], seen[-4, -4]
    assert red[0] > 150 > 60 > red[2]
    assert blue[2] > 150 > 60 > blue[0]
    comment = Image.open(io.BytesIO(stream)).info.get("comment")
    assert comment == (b"XPL-RGB1" if layout == "native" else None)


@native
def test_a_file_says_the_order_of_its_channels(file: h5py.File) -> None:
    assert "standard RGB" in file["vision/cam_head/colors"].attrs["channel_order"]
    assert jpeg.marked(file["rtphys/last/head_camera/rgb"][()])


def test_extras_name_their_units(file: h5py.File) -> None:
    missing = []

    def look(name: str, node: object) -> None:
        if isinstance(node, h5py.Dataset) and not name.startswith("last/"):
            missing.extend([] if node.attrs.get("unit") else [name])

    file["rtphys"].visititems(look)
    assert missing == []


def test_nothing_is_lost(file: h5py.File, made, layout: str) -> None:
    frames, images = made
    read = read_frames(file, layout)
    for key, (array, _) in frames.shapes().items():
        stored = read.shapes()[key][0]
        np.testing.assert_array_equal(stored, np.asarray(array).astype(stored.dtype), err_msg=key)
        if not key.startswith("cameras/"):
            assert stored.dtype.kind != "f" or stored.dtype == np.float64, key
    assert read.stages == frames.stages
    assert read.joint_names == frames.joint_names
    for name, streams in images.jpegs.items():
        expected = streams, (synthetic.HEIGHT, synthetic.WIDTH, 3)
        assert read_pictures(file, layout, name) == expected


def test_nothing_is_stored_twice(file: h5py.File, made, layout: str) -> None:
    """But for what the official layouts repeat themselves, or hold less exactly."""
    again = derived(made[0], layout)
    seen: dict[bytes, str] = {}

    def look(name: str, node: object) -> None:
        if isinstance(node, h5py.Dataset) and name not in again and "intrinsic" not in name:
            data = node[()]
            if isinstance(data, np.ndarray) and data.nbytes > 100 and data.dtype.kind == "f":
                assert seen.setdefault(data[: T - 2].tobytes(), name) == name

    file.visititems(look)
    assert len(seen) > 10


def test_same_input_same_bytes(made, layout: str) -> None:
    frames, images = made
    again = encode_images(synthetic.pictures(3, T), layout)
    first, second = (episode_bytes(layout, frames, i, SEEN) for i in (images, again))
    assert first == second
