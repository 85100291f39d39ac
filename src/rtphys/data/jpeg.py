"""The JPEG streams of both generations of official files, and pictures for pages.

XPolicyLab's writers of today store standard RGB JPEGs and mark each by a comment right after its
JFIF header. What is not marked is "legacy": the official writer of before hands RGB to an encoder
that takes BGR, so `cv2.imdecode` gives RGB, and everything else sees red as blue.
"""

import cv2
import numpy as np
import simplejpeg
from numpy.typing import NDArray

from rtphys.core.bounds import MAX_PIXELS, MAX_SCANS
from rtphys.core.errors import RtphysError

QUALITY = 95
MARK = b"\xff\xfe\x00\x0aXPL-RGB1"  # the whole segment
SCAN = b"\xff\xda"  # begins a scan; the bytes within one cannot say this


class BadImage(RtphysError):
    """Bytes that are no JPEG picture."""


def encode(rgb: NDArray[np.uint8], layout: str = "native") -> bytes:
    """Stream of an RGB picture (H, W, 3): standard and marked, or as files of "legacy" have it."""
    if layout == "legacy":
        return _encoded(rgb)
    stream = true_colour(rgb)
    header = 4 + int.from_bytes(stream[4:6], "big")  # OpenCV's JFIF header begins at byte 2
    return stream[:header] + MARK + stream[header:]


def _encoded(bgr: NDArray[np.uint8]) -> bytes:
    done, stream = cv2.imencode(".jpg", bgr, [cv2.IMWRITE_JPEG_QUALITY, QUALITY])
    if not done:
        raise BadImage(f"a picture of shape {bgr.shape} cannot be encoded")
    return stream.tobytes()


def decode(stream: bytes) -> NDArray[np.uint8]:
    """RGB picture (H, W, 3) of a stored stream of either kind. Raises `BadImage`."""
    height, width, _ = shape_of(stream)
    if height * width > MAX_PIXELS:
        raise BadImage(f"a picture of {width}x{height} pixels; at most {MAX_PIXELS} are decoded")
    # Each scan goes through the whole picture. A picture of 10 kB is counted in 10 microseconds.
    if stream.count(SCAN) > MAX_SCANS:
        raise BadImage(f"a picture of more than {MAX_SCANS} scans")
    # The pixels of cv2.imdecode in half its time, and a damaged stream is an error.
    try:
        return simplejpeg.decode_jpeg(stream, "RGB" if marked(stream) else "BGR")
    except (ValueError, KeyError) as problem:
        raise BadImage(f"{len(stream)} bytes are no JPEG picture: {problem}") from problem


def for_layout(stream: bytes, layout: str) -> bytes:
    """The stream itself if it is of the kind that files of a layout hold, else encoded again.

    JPEG mixes the channels, so exchanging two of them changes pixels a little. Raises `BadImage`.
    """
    return stream if marked(stream) == (layout == "native") else encode(decode(stream), layout)


def marked(stream: bytes) -> bool:
    """Whether the comment right after its JFIF header says that the picture is standard RGB."""
    header = 4 + int.from_bytes(stream[4:6], "big")
    return stream[:4] == b"\xff\xd8\xff\xe0" and stream.startswith(MARK, header)


def shape_of(stream: bytes) -> tuple[int, int, int]:
    """(H, W, 3) of a stored stream, by its header alone. Raises `BadImage`."""
    try:
        height, width, _, _ = simplejpeg.decode_jpeg_header(stream)
    except (ValueError, KeyError) as problem:  # a key: an unknown kind of colours
        raise BadImage(f"{len(stream)} bytes are no JPEG picture: {problem}") from problem
    return int(height), int(width), 3


def true_colour(rgb: NDArray[np.uint8]) -> bytes:
    """A standard JPEG of an RGB picture without the mark, for browsers; not for dataset files."""
    return _encoded(np.asarray(cv2.cvtColor(rgb, cv2.COLOR_RGB2BGR), np.uint8))


def encode_png(rgb: NDArray[np.uint8]) -> bytes:
    """PNG of an RGB picture."""
    return cv2.imencode(".png", cv2.cvtColor(rgb, cv2.COLOR_RGB2BGR))[1].tobytes()


def thumbnail(rgb: NDArray[np.uint8], width: int) -> bytes:
    """A small ordinary JPEG of an RGB picture, at most `width` wide [px]."""
    height = round(rgb.shape[0] * width / rgb.shape[1])
    small = cv2.resize(rgb, (width, height), interpolation=cv2.INTER_AREA)
    return true_colour(np.asarray(small, np.uint8))
