"""Turns the stream of pictures into JPEG streams and the video while the next frame renders."""

import time
from collections import deque
from collections.abc import Iterable
from concurrent.futures import Future, ThreadPoolExecutor
from dataclasses import dataclass, field

from rtphys.data import jpeg
from rtphys.data.episode import Images
from rtphys.data.faults import BadEpisode
from rtphys.data.video import VideoWriter
from rtphys.spec.recording import HEAD

VIDEO_CAMERA = HEAD
AHEAD = 8  # frames the renderer may be ahead of the encoder; bounds the memory


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
