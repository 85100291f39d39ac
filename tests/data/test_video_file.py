"""The MP4: what players expect, the same bits twice; one from a stranger costs little."""

import resource
import subprocess
import sys
import time
import tracemalloc
from fractions import Fraction
from pathlib import Path

import numpy as np
import pytest
import synthetic

from rtphys.core import bounds
from rtphys.data import video
from rtphys.data.check_episode import check_video
from rtphys.data.faults import BadEpisode
from rtphys.data.video import encode_images

MB = 2**20


@pytest.fixture(scope="module")
def data() -> bytes:
    return encode_images(synthetic.pictures(1, 20)).video


def test_facts(data: bytes) -> None:
    facts = video.probe(data)
    assert facts == video.VideoFacts("h264", synthetic.WIDTH, synthetic.HEIGHT, 30.0, 20)
    assert video.frame_count(data) == 20


def test_index_comes_first(data: bytes) -> None:
    order = [kind for kind, _, _ in video.boxes(data, 0, len(data))]
    assert order.index(b"moov") < order.index(b"mdat")
    assert video.index_first(data) == data


def test_a_joined_video_is_not_held_in_memory(data: bytes, tmp_path: Path) -> None:
    times = 6 * MB // len(data)
    out = tmp_path / "joined.mp4"
    tracemalloc.start()
    joined = video.VideoJoiner(out, Fraction(video.FPS))
    for _ in range(times):
        joined.add(data)
    joined.finish()
    _, peak = tracemalloc.get_traced_memory()
    tracemalloc.stop()
    whole = out.read_bytes()
    assert len(whole) > 4 * MB and peak < len(whole) / 2
    assert [path.name for path in tmp_path.iterdir()] == [out.name]
    assert video.frame_count(whole) == 20 * times
    assert video.index_first(whole) == whole
    kinds = [kind for kind, _, _ in video.boxes(whole, 0, len(whole))]
    assert kinds.index(b"moov") < kinds.index(b"mdat")


def test_a_full_disk_is_no_fault_of_the_video(data: bytes, tmp_path: Path) -> None:
    joined = video.VideoJoiner(tmp_path / "joined.mp4", Fraction(video.FPS))
    before = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (MB // 4, before[1]))
    try:
        with pytest.raises(OSError, match="File too large"):
            for _ in range(MB // len(data)):
                joined.add(data)
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, before)


def test_colours_are_true(data: bytes) -> None:
    first = next(video.decode(data))
    assert first[-4, 4].argmax() == 0
    assert first[-4, -4].argmax() == 2


def test_pictures_survive(data: bytes) -> None:
    pairs = zip(video.decode(data), synthetic.pictures(1, 20), strict=True)
    errors = [np.abs(got.astype(int) - want["head_camera"]).mean() for got, want in pairs]
    assert max(errors) < 12


def test_same_pictures_same_bits(data: bytes) -> None:
    assert encode_images(synthetic.pictures(1, 20)).video == data
    assert encode_images(synthetic.pictures(2, 20)).video != data


@pytest.mark.parametrize("cut", [0, 10, 0.5])
def test_damage_is_a_sentence(data: bytes, cut: float) -> None:
    part = data[: int(len(data) * cut) if cut < 1 else int(cut)]
    for look in (video.probe, video.frame_count):
        with pytest.raises(video.BadVideo, match="no readable video"):
            look(part)


def test_an_error_of_the_renderer_comes_out() -> None:
    def broken():
        yield next(iter(synthetic.pictures(1, 2)))
        raise RuntimeError("device lost")

    with pytest.raises(RuntimeError, match="device lost"):
        encode_images(broken())


def test_changing_cameras_are_refused() -> None:
    frames = [dict(frame) for frame in synthetic.pictures(1, 30)]
    del frames[9]["left_camera"]
    with pytest.raises(BadEpisode, match="pictures change"):
        encode_images(frames)


ABANDONED = """
import gc
import rtphys
import numpy as np
from rtphys.data.video import VideoWriter

for _ in range(5):
    writer = VideoWriter(48, 64)
    for _ in range(60):
        writer.add(np.zeros((48, 64, 3), np.uint8))
    writer.itself = writer  # as a traceback does that holds its frame
    del writer
    gc.collect()
"""


def test_an_abandoned_writer_does_not_crash_the_garbage_collector() -> None:
    done = subprocess.run([sys.executable, "-c", ABANDONED], capture_output=True, text=True)
    assert done.returncode == 0, done.stderr


# ---- from a stranger: it opens no other file, and costs little ----------------------------------

SECONDS = 5.0  # [s] of CPU
MEMORY = 2**28  # [bytes] more than before


def clip(height: int = 48, width: int = 64, frames: int = 20) -> bytes:
    writer = video.VideoWriter(height, width)
    for number in range(frames):
        writer.add(np.full((height, width, 3), number % 256, np.uint8))
    return writer.finish()


@pytest.fixture
def elsewhere(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> str:
    """Name of a sound video in the working folder."""
    monkeypatch.chdir(tmp_path)
    (tmp_path / "secret.mp4").write_bytes(clip())
    return "secret.mp4"


LISTS = (
    "ffconcat version 1.0\nfile {0}\n",
    "#EXTM3U\n#EXT-X-VERSION:3\n#EXT-X-TARGETDURATION:1\n#EXTINF:1,\n{0}\n#EXT-X-ENDLIST\n",
    '<?xml version="1.0"?><MPD xmlns="urn:mpeg:dash:schema:mpd:2011"><BaseURL>{0}</BaseURL></MPD>',
)


@pytest.mark.parametrize("text", LISTS)
def test_a_list_of_other_files_is_no_video(text: str, elsewhere: str) -> None:
    data = text.format(elsewhere).encode()
    for read in (video.probe, video.frame_count, lambda d: next(video.decode(d))):
        with pytest.raises(video.BadVideo):
            read(data)


@pytest.mark.parametrize("size", [(2050, 2052), (4320, 7680)])
def test_a_frame_larger_than_any_picture(size: tuple[int, int]) -> None:
    data = clip(*size, frames=1)
    peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    with pytest.raises(video.BadVideo):
        video.probe(data)
    with pytest.raises(video.BadVideo):
        next(video.decode(data))
    assert (resource.getrusage(resource.RUSAGE_SELF).ru_maxrss - peak) * 1024 < MEMORY


def test_no_more_frames_are_decoded_than_were_recorded(tmp_path: Path) -> None:
    path = tmp_path / "long.mp4"
    path.write_bytes(clip(frames=3000))
    assert video.probe(path.read_bytes(), 9).frames == 9
    began = time.process_time()
    assert "frames=9" in check_video(path, 8, (48, 64))[0]
    assert time.process_time() - began < SECONDS


@pytest.mark.parametrize("box", [b"\0\0\0\x08free", b"\0\0\0\x01free" + (16).to_bytes(8, "big")])
def test_a_million_empty_boxes(box: bytes) -> None:
    began = time.process_time()
    with pytest.raises(video.BadVideo):
        video.frame_count(box * 2_000_000)
    assert time.process_time() - began < SECONDS / 10


@pytest.mark.parametrize("size", [0, 7, 2**31, 2**32 - 1])
@pytest.mark.parametrize("kind", ["moov", "trak", "stsz", "avcC", "stts", "stco"])
def test_a_box_of_any_size(kind: str, size: int) -> None:
    data = bytearray(clip())
    at = data.index(kind.encode()) - 4
    data[at : at + 4] = size.to_bytes(4, "big")
    began = time.process_time()
    for read in (video.probe, video.frame_count, lambda d: [*video.decode(d)]):
        try:
            read(bytes(data))
        except video.BadVideo as error:
            assert "\n" not in str(error)
    assert time.process_time() - began < SECONDS


def test_a_file_larger_than_any_video(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(video, "LARGEST_VIDEO", 100)
    with pytest.raises(video.BadVideo, match="at most 100"):
        video.probe(clip())
    assert bounds.LARGEST_VIDEO > 50_000_000
