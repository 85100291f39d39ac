"""Senses in both layouts: official keys, types and palette; readers, conversion, verification."""

import io
from collections.abc import Callable
from pathlib import Path

import h5py
import numpy as np
import pytest
import sensing
import synthetic
from collected import content_but_pictures, write
from PIL import ImageColor

from rtphys.core.errors import BadFile, UnknownName
from rtphys.data.check_episode import check_hdf5
from rtphys.data.dataset import Dataset
from rtphys.data.hdf5_episode import episode_bytes, read_episode
from rtphys.data.hdf5_file import packed, write_packed
from rtphys.data.palette import PALETTE, coloured, row_of
from rtphys.data.rewrite import convert
from rtphys.data.verify import verify
from rtphys.data.video import encode_images
from rtphys.senses.depth import DEPTH_STEPS

T, H, W = 8, synthetic.HEIGHT, synthetic.WIDTH
R = T - 1
OFFICIAL = {
    "legacy": {
        "observation/head_camera/depth": ((T, H, W), np.float64),
        "observation/left_camera/mesh_segmentation": ((T, H, W, 3), np.uint8),
        "observation/right_camera/actor_segmentation": ((T, H, W, 3), np.uint8),
        "pointcloud": ((T, 1024, 6), np.float32),
    },
    "native": {
        "vision/cam_head/depths": ((R, H, W), np.float64),
        "vision/cam_left_wrist/mesh_segmentation": ((R, H, W, 3), np.uint8),
        "vision/cam_right_wrist/actor_segmentation": ((R, H, W, 3), np.uint8),
        "pointclouds": ((R, 1024, 6), np.float32),
    },
}


def opened(layout: str, senses: tuple[str, ...] = sensing.SENSES) -> h5py.File:
    return h5py.File(io.BytesIO(file_of(layout, senses)))


def file_of(layout: str, senses: tuple[str, ...] = sensing.SENSES) -> bytes:
    frames, images = synthetic.frames_of(4, T), encode_images(synthetic.pictures(4, T), layout)
    made = sensing.sensed(4, T, senses) if senses else None
    return episode_bytes(layout, frames, images, ["ring the bell"], made)


@pytest.mark.parametrize("layout", OFFICIAL)
def test_official_keys_and_types(layout: str) -> None:
    with opened(layout) as file:
        for key, (shape, dtype) in OFFICIAL[layout].items():
            assert (file[key].shape, file[key].dtype) == (shape, dtype), key
            chunks = None if "pointcloud" in key else (1, *shape[1:])
            assert file[key].chunks == chunks, key
        depth = next(key for key in OFFICIAL[layout] if "depth" in key)
        expected = sensing.sensed(4, T).tracks["depth", "head_camera"][2].astype(np.float64) * 1000
        assert np.allclose(file[depth][2], expected, rtol=0, atol=1e-3), "not millimetres"
        assert not np.any(file[depth][2] * DEPTH_STEPS % 1), "more digits than the camera gives"


@pytest.mark.parametrize("dtype", ["f8", "f4", "u1"])
@pytest.mark.parametrize("most", [1, 3, 10**9])
def test_hdf5_reads_what_another_library_deflated(dtype: str, most: int) -> None:
    """From nothing at all up to frames that cannot be made smaller; by HDF5's own filters."""
    rng = np.random.default_rng(most)
    frames = rng.integers(0, most, (3, 24, 31)).astype(dtype)
    with h5py.File.in_memory() as file:
        made = packed(file, "frames", frames.shape, frames.dtype)
        for t in (2, 0, 1):
            write_packed(made, t, frames[t])
        file.flush()
        image = file.id.get_file_image()
    with h5py.File(io.BytesIO(image), "r") as file:
        assert np.array_equal(file["frames"][()], frames)
        assert (file["frames"].compression, file["frames"].shuffle) == ("gzip", dtype != "u1")


def test_a_picture_has_the_colours_of_its_ids() -> None:
    ids = np.arange(256, dtype=np.uint8).reshape(8, 32)
    for view in (ids, ids[:, ::2], ids.T):
        assert np.array_equal(coloured(view), PALETTE[view.astype(int) % len(PALETTE)])


@pytest.mark.parametrize("layout", OFFICIAL)
def test_everything_else_is_the_same_without_senses(layout: str) -> None:
    with opened(layout) as sensing_file, opened(layout, ()) as plain:
        keys: list[str] = []
        plain.visititems(lambda k, v: keys.append(k) if isinstance(v, h5py.Dataset) else None)
        assert len(keys) > 25
        for key in keys:
            if key != "pointcloud":
                assert np.array_equal(plain[key][()], sensing_file[key][()]), key


def test_the_palette_is_pillow_s() -> None:
    # Pillow puts a colour there as numbers once somebody has asked for it.
    official = sorted({ImageColor.getrgb(name)[:3] for name in list(ImageColor.colormap)})
    assert np.array_equal(PALETTE, official)
    ids = np.arange(139, dtype=np.uint8).reshape(1, -1)
    assert np.array_equal(row_of(coloured(ids)), ids)
    assert np.array_equal(coloured(np.array([140])), PALETTE[[1]])
    with pytest.raises(ValueError, match="palette"):
        row_of(np.array([[[1, 2, 3]]], np.uint8))


# ---- other people's readers ----------------------------------------------------------------------


def dp3_arrays(source: io.BytesIO) -> dict[str, np.ndarray]:
    """What DP3's converter takes of a legacy file: every row but the last, and the next vector."""
    with h5py.File(source, "r") as root:
        vector, clouds = root["/joint_action/vector"][()], root["/pointcloud"][()]
    return {
        "point_cloud": np.array([clouds[i] for i in range(len(vector) - 1)], np.float32),
        "state": vector[:-1].astype(np.float32),
        "action": vector[1:].astype(np.float32),
    }


def test_dp3_reads_the_clouds() -> None:
    taken = dp3_arrays(io.BytesIO(file_of("legacy")))
    made = sensing.sensed(4, T)
    assert taken["point_cloud"].shape == (R, 1024, 6)
    assert np.array_equal(taken["point_cloud"], made.tracks["cloud", ""][:-1])
    assert taken["state"].shape == taken["action"].shape == (R, 14)


def test_without_clouds_the_legacy_key_is_there_and_empty() -> None:
    with opened("legacy", ("depth",)) as file:
        assert file["pointcloud"].shape == (T, 0)


# ---- our own reader, conversion, verification ----------------------------------------------------


@pytest.mark.parametrize("layout", OFFICIAL)
def test_our_reader_gives_metres_ids_and_names(tmp_path: Path, layout: str) -> None:
    episode = sensing.collect(tmp_path, 2, T, layout=layout)[1]
    made, senses = sensing.sensed(1, T), episode.senses
    assert senses.senses == sensing.SENSES
    for t in (0, T - 1, -1):
        assert np.array_equal(
            senses.depth("left_camera", t), made.tracks["depth", "left_camera"][t]
        )
        assert np.array_equal(senses.ids("head_camera", t), made.tracks["actors", "head_camera"][t])
        assert np.array_equal(
            senses.ids("head_camera", t, "mesh"), made.tracks["meshes", "head_camera"][t]
        )
        assert np.array_equal(senses.cloud(t), made.tracks["cloud", ""][t])
    assert senses.names()[2] == "bell"
    assert np.array_equal(senses.bodies().poses, made.tracks["bodies", ""])
    with pytest.raises(IndexError):
        senses.depth("head_camera", T)
    with pytest.raises(UnknownName, match="head_camera"):
        senses.depth("haed_camera", 0)
    assert np.array_equal(senses.depth("head", 0), senses.depth("head_camera", 0))


def test_what_was_not_recorded_is_named(tmp_path: Path) -> None:
    episode = sensing.collect(tmp_path, 1, T, ("depth",))[0]
    with pytest.raises(UnknownName, match="unknown sense 'pointcloud'"):
        episode.senses.cloud(0)


def test_conversion_there_and_back_loses_nothing(tmp_path: Path) -> None:
    native = sensing.collect(tmp_path / "native", 2, T).path
    convert(native, tmp_path / "legacy", "legacy")
    convert(tmp_path / "legacy", tmp_path / "back", "native")
    assert content_but_pictures(tmp_path / "back") == content_but_pictures(native)
    assert verify(tmp_path / "legacy").problems == []
    _, _, sensed = read_episode(Dataset(tmp_path / "legacy")[0].paths.hdf5, "legacy")
    assert sensed is not None and sensed.senses == sensing.SENSES


def put(key: str, value: object) -> Callable[[h5py.File], None]:
    """Of one pixel or point of frame 3."""
    return lambda file: file[key].__setitem__((3, 0, 0), value)


def cut_short(file: h5py.File) -> None:
    rows = file["pointclouds"][:-1]
    del file["pointclouds"]
    file["pointclouds"] = rows


@pytest.mark.parametrize(
    ("spoil", "words"),
    [
        (put("vision/cam_head/actor_segmentation", (1, 2, 3)), "not of the palette"),
        (put("vision/cam_head/mesh_segmentation", PALETTE[90]), "without a name"),
        (put("vision/cam_head/depths", -1.0), "below 0"),
        (put("pointclouds", np.inf), "not finite"),
        (lambda file: file.pop("vision/cam_left_wrist/depths"), "cam_left_wrist/depths is missing"),
        (lambda file: file["rtphys"].attrs.pop("senses"), "not declared"),
        (cut_short, "pointclouds is float32"),
    ],
)
def test_a_wrong_value_is_named(
    tmp_path: Path, spoil: Callable[[h5py.File], object], words: str
) -> None:
    """Even where digests are those of the changed file."""
    path = tmp_path / "episode.hdf5"
    path.write_bytes(file_of("native"))
    with h5py.File(path, "r+") as file:
        spoil(file)
    found = check_hdf5(path, "native", decode=True).problems
    assert any(words in text for text in found), found


def test_a_manifest_that_claims_other_senses_is_caught(tmp_path: Path) -> None:
    write(tmp_path, synthetic.episode(0, T), what=synthetic.header(senses=("depth",)))
    assert any("holds senses ()" in str(problem) for problem in verify(tmp_path).problems)


def test_body_poses_without_their_names_are_refused(tmp_path: Path) -> None:
    path = tmp_path / "episode.hdf5"
    path.write_bytes(file_of("legacy"))
    with h5py.File(path, "r+") as file:
        file["rtphys/names/body"][()] = '["ground"]'
    (problem,) = check_hdf5(path, "legacy", decode=True).problems
    assert "body_poses is float32 (8, 3, 7), not float32 (8, 1, 7)" in problem
    with h5py.File(path, "r+") as file:
        del file["rtphys/names/body"]
    with pytest.raises(BadFile, match="names/body"):
        read_episode(path, "legacy")
