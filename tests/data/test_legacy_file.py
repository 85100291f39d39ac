"""The legacy file against the official specification, and the way to native and back."""

import h5py
import numpy as np
import pytest
import synthetic

from rtphys.data.encode import encode_images
from rtphys.data.hdf5_file import open_read
from rtphys.data.hdf5_legacy import legacy_bytes, read_legacy
from rtphys.data.hdf5_native import native_bytes, read_native

T = 8
OFFICIAL = {
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


@pytest.fixture(scope="module")
def made():
    return synthetic.frames_of(4, T), encode_images(synthetic.pictures(4, T))


@pytest.fixture(scope="module")
def file(made):
    with open_read(legacy_bytes(*made)) as opened:
        yield opened


@pytest.mark.parametrize("key", OFFICIAL)
def test_official_key(file: h5py.File, key: str) -> None:
    shape, dtype = OFFICIAL[key]
    assert file[key].shape == shape
    assert file[key].dtype == dtype
    assert file[key].chunks is None


def test_vector_is_left_then_right(file: h5py.File) -> None:
    action = file["joint_action"]
    expected = np.column_stack(
        [action["left_arm"], action["left_gripper"], action["right_arm"], action["right_gripper"]]
    )
    np.testing.assert_array_equal(action["vector"], expected)
    np.testing.assert_array_equal(file["endpose/left_gripper"], action["left_gripper"])


def test_every_picture_is_there(file: h5py.File, made) -> None:
    _, images = made
    for name, streams in images.jpegs.items():
        assert list(file[f"observation/{name}/rgb"][()]) == streams
        assert file[f"observation/{name}/rgb"].dtype.itemsize == max(map(len, streams))


def test_official_part_has_no_attributes(file: h5py.File) -> None:
    assert not file.attrs
    named: list[str] = []
    file.visititems(lambda name, node: named.append(name) if node.attrs else None)
    assert all(name.startswith("rtphys") for name in named)


def test_native_to_legacy_to_native_is_the_identity(made) -> None:
    words = ["ring the bell"]
    native = native_bytes(*made, words, "")
    with open_read(native) as file:
        frames, images, _ = read_native(file)
    legacy = legacy_bytes(frames, images)
    assert legacy == legacy_bytes(*made)
    with open_read(legacy) as file:
        frames, images = read_legacy(file)
    assert native_bytes(frames, images, words, "") == native
