"""Pictures as an episode's files hold them: JPEG streams, and the head camera's MP4.

The MP4 is H.264, 30 fps, index in front; the same pictures give the same bits.
"""

import io
import struct
import time
from collections import deque
from collections.abc import Iterable, Iterator
from concurrent.futures import Future, ThreadPoolExecutor
from contextlib import contextmanager, suppress
from dataclasses import dataclass, field
from fractions import Fraction
from itertools import islice
from pathlib import Path
from typing import Any

import av
import cv2
import numpy as np
from av.container import InputContainer
from av.error import FFmpegError
from av.video.stream import VideoStream
from numpy.typing import NDArray

from rtphys.core.bounds import LARGEST_VIDEO, MAX_BOXES, MAX_FRAMES, MAX_PIXELS
from rtphys.core.errors import RtphysError
from rtphys.data import jpeg
from rtphys.data.episode import Images
from rtphys.data.faults import BadEpisode
from rtphys.spec.recording import HEAD

FPS = 30  # official: plays 1.8 times faster than the 16.67 Hz of the frames
CRF = "23"
PRESET = "veryfast"  # 0.8 ms a 320x240 frame against 1.9 ms of "medium", at the same size
VIDEO_CAMERA = HEAD
AHEAD = 8  # frames the renderer may be ahead of the encoder; bounds the memory


class BadVideo(RtphysError):
    """Bytes that are no whole MP4."""


class VideoWriter:
    """Encodes RGB pictures (H, W, 3) into an MP4 in memory; H and W must be even.

    Args:
        height, width: of every picture [px].
        rate: pictures a second.
        keyframes: at least every so many pictures; None leaves it to the encoder. Random access
            costs as many decoded pictures, so training formats want few.
        depth: pictures are (H, W) uint16 below 4096 instead, and encoded without loss (HEVC).
    """

    def __init__(
        self,
        height: int,
        width: int,
        rate: Fraction = Fraction(FPS),
        keyframes: int | None = None,
        depth: bool = False,
    ) -> None:
        self._buffer = io.BytesIO()
        # bitexact keeps the library's version and the date out of the file.
        self._container = av.open(self._buffer, "w", format="mp4", options={"fflags": "+bitexact"})
        codec, pixels = ("libx265", "gray12le") if depth else ("libx264", "yuv420p")
        stream = self._container.add_stream(codec, rate=rate)
        assert isinstance(stream, VideoStream)
        stream.width, stream.height, stream.pix_fmt = width, height, pixels
        # x264 changes its decisions with the thread count, so the count is part of the format.
        # Its macroblock tree (AVX-512) gave other bits in 1 of 250 identical 320x240 videos.
        stream.options = {"preset": PRESET, "crf": CRF, "threads": "1", "x264-params": "mbtree=0"}
        if depth:
            lossless = "lossless=1:pools=none:frame-threads=1:info=0:log-level=none"
            stream.options = {"preset": "ultrafast", "x265-params": lossless}
        if keyframes is not None:
            stream.options |= {"g": str(keyframes), "bf": "0"}
        self._stream = stream

    def add(self, picture: NDArray[np.uint8 | np.uint16]) -> None:
        if picture.ndim == 2:
            frame = av.VideoFrame(picture.shape[1], picture.shape[0], "gray12le")
            plane = np.frombuffer(frame.planes[0], np.uint16).reshape(len(picture), -1)  # type: ignore[call-overload]
            plane[:, : picture.shape[1]] = picture
            self._container.mux(self._stream.encode(frame))
            return
        # PyAV's own way from RGB takes a third of the encoder's time, this one a twentieth.
        planes = np.asarray(cv2.cvtColor(picture, cv2.COLOR_RGB2YUV_I420), np.uint8)
        # Not copied: each picture has planes of its own, which live as long as the encoder needs.
        frame = av.VideoFrame.from_numpy_buffer(planes, format="yuv420p")
        self._container.mux(self._stream.encode(frame))

    def finish(self) -> bytes:
        """The whole file. The writer cannot be used afterwards."""
        self._container.mux(self._stream.encode())
        self._container.close()
        return index_first(self._buffer.getvalue())

    def __del__(self) -> None:
        # The collector may clear the buffer of an abandoned writer before PyAV writes the file's
        # end into it: a segmentation fault. It calls this before it clears anything.
        with suppress(Exception):
            self._container.close()


@dataclass
class EncodedImages:
    """Everything the files need of T frames of pictures."""

    jpegs: dict[str, list[bytes]] = field(default_factory=dict)  # camera -> T streams
    video: bytes = b""
    cpu_s: float = 0.0  # [s] of the encoding thread


def encode_images(images: Iterable[Images], layout: str = "native") -> EncodedImages:
    """Encodes frame after frame in a second thread; an exception of either side comes out here.

    cv2 and PyAV release the GIL while they work.

    Args:
        images: T frames; all have the same cameras and sizes.
        layout: of the file that the streams are for, which decides about their channels.
    """
    made, sizes = EncodedImages(), dict[str, tuple[int, ...]]()
    video: VideoWriter | None = None

    def encode(frame: Images) -> None:
        nonlocal sizes, video
        shapes = {name: picture.shape for name, picture in frame.items()}
        if not made.jpegs:
            sizes, made.jpegs = shapes, {name: [] for name in frame}
            if VIDEO_CAMERA in frame:
                video = VideoWriter(*frame[VIDEO_CAMERA].shape[:2])
        if shapes != sizes:
            raise BadEpisode([f"pictures change from {sizes} to {shapes}"])
        for name, picture in frame.items():
            made.jpegs[name].append(jpeg.encode(picture, layout))
        if video is not None:
            video.add(frame[VIDEO_CAMERA])

    def finish() -> None:
        made.video = b"" if video is None else video.finish()
        made.cpu_s = time.thread_time()

    with ThreadPoolExecutor(1, "rtphys-encode") as pool:
        waiting = deque[Future[None]]()
        for frame in images:
            waiting.append(pool.submit(encode, frame))
            if len(waiting) > AHEAD:
                waiting.popleft().result()
        for one in (*waiting, pool.submit(finish)):
            one.result()
    return made


class VideoJoiner:
    """Appends MP4s of `VideoWriter`, of one size and rate, to one MP4 without encoding again.

    It grows in the file, so memory does not follow its size. What the file system refuses is an
    OSError.
    """

    def __init__(self, path: Path, rate: Fraction) -> None:
        options = {"fflags": "+bitexact", "movflags": "+faststart"}
        self._container = av.open(path, "w", format="mp4", options=options)
        self._rate, self._frames = rate, 0
        self._stream: VideoStream | None = None
        self.size = 0  # bytes of pictures so far

    def add(self, data: bytes) -> None:
        """Append the pictures of an MP4. Raises `BadVideo`."""
        with _opened(data) as (source, stream):
            self._stream = self._stream or self._container.add_stream_from_template(stream)
            later = self._frames / self._rate / Fraction(stream.time_base or 1)
            packets = [*source.demux(stream)]
        for packet in packets:  # here, since what a disk refuses is no fault of the MP4
            if packet.pts is None or packet.dts is None:  # the end
                continue
            packet.pts, packet.dts = packet.pts + int(later), packet.dts + int(later)
            packet.stream = self._stream
            self.size += packet.size
            self._container.mux(packet)
            self._frames += 1

    def finish(self) -> None:
        """The file is whole. The joiner cannot be used afterwards."""
        self._container.close()


def boxes(data: bytes, start: int, end: int) -> Iterator[tuple[bytes, int, int]]:
    """(type, first byte, end) of the MP4 boxes between two offsets."""
    while start < end:
        size, kind = struct.unpack_from(">I4s", data, start)
        if size == 1:  # 64-bit size follows the type
            (size,) = struct.unpack_from(">Q", data, start + 8)
        if size < 8:
            raise ValueError(f"MP4 box {kind!r} at byte {start} has size {size}")
        yield kind, start, start + size
        start += size


def index_first(data: bytes) -> bytes:
    """Moves the index (`moov`) before the pictures, so that a browser starts at once.

    FFmpeg's own `faststart` re-opens the file by name, which a file in memory has not.
    """
    found = {kind: (start, end) for kind, start, end in boxes(data, 0, len(data))}
    moov_start, moov_end = found[b"moov"]
    mdat_start, _ = found[b"mdat"]
    if moov_start < mdat_start:
        return data
    moov = bytearray(data[moov_start:moov_end])
    _shift_chunks(moov, len(moov))
    return data[:mdat_start] + moov + data[mdat_start:moov_start] + data[moov_end:]


def _shift_chunks(moov: bytearray, shift: int) -> None:
    """Adds `shift` to every chunk offset of an index, in place."""
    pending = [(8, len(moov))]
    while pending:
        start, end = pending.pop()
        for kind, first, last in boxes(bytes(moov), start, end):
            if kind in (b"trak", b"mdia", b"minf", b"stbl"):
                pending.append((first + 8, last))
            elif kind in (b"stco", b"co64"):
                form = "I" if kind == b"stco" else "Q"
                (count,) = struct.unpack_from(">I", moov, first + 12)
                offsets = struct.unpack_from(f">{count}{form}", moov, first + 16)
                struct.pack_into(
                    f">{count}{form}", moov, first + 16, *(offset + shift for offset in offsets)
                )


@dataclass(frozen=True)
class VideoFacts:
    """What an MP4 says and holds."""

    codec: str
    width: int
    height: int
    fps: float
    frames: int  # decoded, not the number in the header


@contextmanager
def _opened(data: bytes) -> Iterator[tuple[InputContainer, VideoStream]]:
    """The first video in an MP4 in memory. Raises `BadVideo`, for errors while it is open too."""
    if len(data) > LARGEST_VIDEO:
        raise BadVideo(f"has {len(data)} bytes; at most {LARGEST_VIDEO} are read")
    try:
        # Named, because FFmpeg would take a list of other files for a video too, and open them.
        with av.open(io.BytesIO(data), "r", format="mp4") as container:
            stream = container.streams.video[0]
            stream.codec_context.options = {"max_pixels": str(MAX_PIXELS)}
            yield container, stream
    except (FFmpegError, IndexError, ValueError, MemoryError) as error:
        raise BadVideo(f"no readable video ({error})") from error


def probe(data: bytes, most: int = MAX_FRAMES) -> VideoFacts:
    """Decodes an MP4, at most so many frames, and says what is in it. Raises `BadVideo`."""
    with _opened(data) as (container, stream):
        stream.codec_context.thread_count = 1
        count = sum(1 for _ in islice(container.decode(stream), most))
        return VideoFacts(
            codec=stream.codec_context.name,
            width=stream.codec_context.width,
            height=stream.codec_context.height,
            fps=float(stream.average_rate or 0),
            frames=count,
        )


def frame_count(data: bytes) -> int:
    """Number of frames by the index, without decoding. Raises `BadVideo`."""
    # Read here, not by FFmpeg, which takes longer to open a file than a verifier for all the rest.
    start, end = 0, len(data)
    try:
        for name in (b"moov", b"trak", b"mdia", b"minf", b"stbl", b"stsz"):
            found = islice(boxes(data, start, end), MAX_BOXES)
            inside = {kind: (first + 8, last) for kind, first, last in found}
            if max((last for _, last in inside.values()), default=0) > end:
                raise ValueError("it is cut short")
            start, end = inside[name]
        (count,) = struct.unpack_from(">I", data, start + 8)  # after flags and the common size
    except (struct.error, KeyError, ValueError) as error:
        raise BadVideo(f"no readable video ({error})") from error
    return count


def decode(data: bytes) -> Iterator[NDArray[Any]]:
    """The pictures of an MP4, (H, W, 3) RGB uint8, or depths (H, W) uint16. Raises `BadVideo`.

    As many as are asked for: of small pictures, a file of an export holds hundreds of thousands.
    """
    with _opened(data) as (container, stream):
        for frame in container.decode(stream):
            yield frame.to_ndarray(
                format="gray12le" if frame.format.name == "gray12le" else "rgb24"
            )
