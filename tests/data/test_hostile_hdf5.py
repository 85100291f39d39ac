"""An HDF5 file from a stranger: one sentence, within seconds, in little memory, nothing outside."""

import os
import resource
import time
import zlib
from pathlib import Path

import h5py
import pytest
import sensing
import synthetic
from hostile_hdf5 import Forgery, forgeries, jpeg_bomb

from rtphys.core.errors import BadFile, RtphysError
from rtphys.data.check_episode import check_hdf5
from rtphys.data.hdf5_episode import EpisodeFile, episode_bytes, read_episode
from rtphys.data.hdf5_file import HEAP, HEAP_HEADER, HEAP_OBJECT, MAX_TEXTS
from rtphys.data.video import encode_images

SECONDS = 5.0  # [s] of CPU; the slowest takes a tenth of it
MEMORY = 2**28  # [bytes] more than before


@pytest.fixture(scope="module")
def sound() -> bytes:
    images = encode_images(synthetic.pictures(3))
    return episode_bytes("native", synthetic.frames_of(3), images, ["ring the bell"])


@pytest.fixture
def outside(tmp_path: Path, sound: bytes) -> Path:
    """A sound file elsewhere, which would do for every part of the forged one."""
    path = tmp_path / "elsewhere" / "secret.hdf5"
    path.parent.mkdir()
    path.write_bytes(sound)
    return path


def refused(path: Path) -> str:
    """What every reader together says; each either answers or raises an `RtphysError`."""
    peak, began = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss, time.process_time()
    said = [*check_hdf5(path, "native", decode=True).problems]
    file = EpisodeFile(path, "native")
    readers = [lambda: read_episode(path, "native"), file.frames]
    readers += [lambda: file.streams("head_camera"), lambda: file.stream("head_camera", 0)]
    for reader in readers:
        try:
            reader()
        except RtphysError as error:
            said.append(str(error))
    assert time.process_time() - began < SECONDS
    assert (resource.getrusage(resource.RUSAGE_SELF).ru_maxrss - peak) * 1024 < MEMORY
    assert all("\n" not in text for text in said)
    return "; ".join(said)


@pytest.mark.parametrize("forgery", [*forgeries()], ids=str)
def test_every_reader_refuses(
    forgery: Forgery, sound: bytes, outside: Path, tmp_path: Path
) -> None:
    path = tmp_path / "forged.hdf5"
    path.write_bytes(sound)
    with h5py.File(path, "r+") as file:
        forgery.forge(file, outside)
    before = path.read_bytes(), outside.read_bytes()
    assert refused(path)
    assert (path.read_bytes(), outside.read_bytes()) == before


def test_the_sound_file_is_refused_by_nobody(sound: bytes, tmp_path: Path) -> None:
    path = tmp_path / "sound.hdf5"
    path.write_bytes(sound)
    assert refused(path) == ""


@pytest.mark.parametrize("number", [0, 1])
@pytest.mark.parametrize("size", [0, 5000, 2**64 - 16, 2**64 - 1])
def test_a_heap_that_hdf5_would_never_end_reading(
    number: int, size: int, sound: bytes, tmp_path: Path
) -> None:
    """No time limit of this process could end that; the number of a free piece is 0."""
    if number and not size:
        pytest.skip("an empty text is sound")
    first = sound.index(HEAP) + HEAP_HEADER
    forged = HEAP_OBJECT.pack(number, size)
    path = tmp_path / "forged.hdf5"
    path.write_bytes(sound[:first] + forged + sound[first + len(forged) :])
    assert f"the text at byte {first} cannot have {size} bytes" in refused(path)


def test_more_heaps_than_texts(sound: bytes, tmp_path: Path) -> None:
    """Each is looked at; a file of nothing else would take minutes."""
    path = tmp_path / "forged.hdf5"
    path.write_bytes(sound + HEAP * (MAX_TEXTS + 1))
    assert "texts" in refused(path)


DEPTHS, IDS = "vision/cam_head/depths", "vision/cam_left_wrist/mesh_segmentation"
ROWS = (7, synthetic.HEIGHT, synthetic.WIDTH)
GZIP = {"compression": "gzip", "chunks": (1, *ROWS[1:])}


@pytest.mark.parametrize(
    ("key", "shape", "options", "words"),
    [
        (DEPTHS, (10**9, *ROWS[1:]), GZIP, "at most"),
        (DEPTHS, (2000, *ROWS[1:]), GZIP, "never written"),
        (DEPTHS, ROWS, GZIP, "never written"),
        (DEPTHS, ROWS, {"compression": "lzf", "chunks": (1, *ROWS[1:])}, "filters"),
        (DEPTHS, ROWS, {"fletcher32": True, **GZIP}, "filters"),
        (DEPTHS, ROWS, {"compression": "gzip", "chunks": ROWS}, "frame by frame"),
        (DEPTHS, (1, 2**12, 2**12), {"compression": "gzip", "chunks": (1, 2**12, 2**12)}, "at mo"),
        (DEPTHS, (2**20,), {"compression": "gzip", "chunks": (1,)}, "frame by frame"),
        (IDS, (10**7, *ROWS[1:], 3), {"compression": "gzip", "chunks": (1, *ROWS[1:], 3)}, "at mo"),
    ],
)
def test_compressed_frames_that_lie(
    key: str, shape: tuple[int, ...], options: dict, words: str, tmp_path: Path
) -> None:
    path = sensed_file(tmp_path)
    with h5py.File(path, "r+") as file:
        dtype = file[key].dtype
        del file[key]
        file.create_dataset(key, shape, dtype, **options)
    assert words in refused(path)


def test_frames_that_grow_out_of_nothing(tmp_path: Path) -> None:
    """A thousand times their size in the file: 3 GB of zeros."""
    path = sensed_file(tmp_path)
    shape = (400, 1000, 1000)
    with h5py.File(path, "r+") as file:
        del file[DEPTHS]
        bomb = file.create_dataset(DEPTHS, shape, "f8", compression="gzip", chunks=(1, *shape[1:]))
        frame = zlib.compress(bytes(8 * 10**6), 9)
        for t in range(len(bomb)):
            bomb.id.write_direct_chunk((t, 0, 0), frame)
    assert path.stat().st_size < 2**22
    assert "at most" in refused(path)


def test_frames_that_do_not_decompress(tmp_path: Path) -> None:
    path = sensed_file(tmp_path)
    with h5py.File(path, "r+") as file:
        whole = file[DEPTHS].id.get_chunk_info(3)
        file[DEPTHS].id.write_direct_chunk((3, 0, 0), b"x" * whole.size)
    assert refused(path)


def sensed_file(folder: Path) -> Path:
    path, images = folder / "sensed.hdf5", encode_images(synthetic.pictures(3))
    made = sensing.sensed(3)
    path.write_bytes(episode_bytes("native", synthetic.frames_of(3), images, ["ring"], made))
    assert refused(path) == ""
    return path


@pytest.mark.parametrize("layout", ["native", "legacy"])
@pytest.mark.parametrize("size", [(65000, 65000), (65000, 1), (3000, 3000), (0, 0)])
def test_a_picture_that_claims_another_size(
    layout: str, size: tuple[int, int], tmp_path: Path
) -> None:
    images, frames = encode_images(synthetic.pictures(3)), synthetic.frames_of(3)
    streams, first = images.jpegs["head_camera"], int(layout == "native")
    streams[first:] = [jpeg_bomb(*size)] * (len(frames) - first)  # the first says a native shape
    path = tmp_path / "bomb.hdf5"
    path.write_bytes(episode_bytes(layout, frames, images, ["x"]))
    peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    assert check_hdf5(path, layout, decode=True).problems
    assert (resource.getrusage(resource.RUSAGE_SELF).ru_maxrss - peak) * 1024 < MEMORY


def test_a_path_that_is_no_file(tmp_path: Path) -> None:
    os.mkfifo(tmp_path / "pipe")
    for path in (tmp_path / "pipe", tmp_path, Path("/dev/zero"), Path("no\0file"), Path("no")):
        with pytest.raises(BadFile):
            EpisodeFile(path, "native").frames()


def test_a_sparse_file_of_terabytes(tmp_path: Path, sound: bytes) -> None:
    path = tmp_path / "sparse.hdf5"
    path.write_bytes(sound)
    with path.open("r+b") as file:
        file.truncate(2**40)
    with pytest.raises(BadFile, match="at most"):
        EpisodeFile(path, "native").frames()
