"""Streams of both generations: what official readers see is what ours sees."""

import importlib.util
import os
import sys
from pathlib import Path
from types import ModuleType

import cv2
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from rtphys.data.jpeg import MARK, SCAN, BadImage, decode, encode, for_layout, marked

LAYOUTS = ("native", "legacy")


def picture(seed: int) -> np.ndarray:
    noise = np.random.default_rng(seed).integers(0, 255, (48, 64, 3), dtype=np.uint8)
    return np.asarray(cv2.GaussianBlur(noise, (0, 0), 2.0), np.uint8)


@settings(max_examples=20)
@given(seed=st.integers(0, 10_000))
def test_decoding_gives_what_official_readers_see(seed: int) -> None:
    """XPolicyLab: imdecode, and exchange the channels of what is marked."""
    for layout, channels in (("native", slice(None, None, -1)), ("legacy", slice(None))):
        stream = encode(picture(seed), layout)
        seen = cv2.imdecode(np.frombuffer(stream, np.uint8), cv2.IMREAD_COLOR)
        np.testing.assert_array_equal(decode(stream), seen[..., channels])


@pytest.mark.parametrize("layout", LAYOUTS)
def test_colours_survive(layout: str) -> None:
    red = np.zeros((48, 64, 3), np.uint8)
    red[..., 0] = 200
    stream = encode(red, layout)
    assert marked(stream) == (layout == "native")
    for other in LAYOUTS:
        again = for_layout(stream, other)
        np.testing.assert_allclose(decode(again).mean(axis=(0, 1)), [200, 0, 0], atol=3)
        assert (again == stream) == (other == layout)


def test_the_mark_is_a_comment_right_after_the_jfif_header() -> None:
    stream = encode(picture(0))
    kinds, at = [], 2
    while stream[at + 1] != SCAN[1]:
        kinds.append(stream[at + 1])
        if stream[at + 1] == 0xFE:
            assert stream[at : at + 12] == bytes.fromhex("fffe000a") + b"XPL-RGB1"
        at += 2 + int.from_bytes(stream[at + 2 : at + 4])
    assert kinds[:2] == [0xE0, 0xFE] and 0xFE not in kinds[2:]
    for changed in (b"", stream[:3], b"xx" + stream[2:], stream.replace(MARK, MARK[:-1] + b"2")):
        assert not marked(changed)


def xpolicylab() -> ModuleType | None:
    """Its `utils/process_data.py`, if RTPHYS_XPOLICYLAB names a checkout of today."""
    where = Path(os.environ.get("RTPHYS_XPOLICYLAB", "")) / "utils" / "process_data.py"
    if not where.is_file():
        return None
    spec = importlib.util.spec_from_file_location("process_data", where)
    assert spec is not None and spec.loader is not None
    module, unused = importlib.util.module_from_spec(spec), ModuleType("XPolicyLab.utils.load_file")
    unused.load_json = unused.load_yaml = None  # type: ignore[attr-defined]
    with pytest.MonkeyPatch.context() as patch:
        patch.setitem(sys.modules, unused.__name__, unused)
        spec.loader.exec_module(module)
    return module


@pytest.mark.skipif(xpolicylab() is None, reason="RTPHYS_XPOLICYLAB names no checkout")
def test_xpolicylab_reads_and_passes_on_what_we_write() -> None:
    theirs = xpolicylab()
    assert theirs is not None
    for layout in LAYOUTS:
        stream = encode(picture(1), layout)
        np.testing.assert_array_equal(theirs.decode_image_bit(stream), decode(stream))
    ours = encode(picture(1))
    assert theirs.encode_image_bit([ours]) == [ours]
    assert theirs.encode_image_bit(picture(1), quality=95) == ours
    with pytest.raises(ValueError, match="unmarked"):
        theirs.encode_image_bit([encode(picture(1), "legacy")])


@pytest.mark.parametrize("keep", [0, 3, 100, 0.5, 0.98])
def test_a_damaged_stream_is_an_error(keep: float) -> None:
    stream = encode(picture(0))
    size = keep if isinstance(keep, int) else int(keep * len(stream))
    with pytest.raises(BadImage, match="no JPEG picture"):
        decode(stream[:size])


def progressive(copies: int) -> bytes:
    """A picture in many scans, the last of which occurs that many times."""
    _, stream = cv2.imencode(".jpg", picture(0), [cv2.IMWRITE_JPEG_PROGRESSIVE, 1])
    data = stream.tobytes()
    last = data.rindex(SCAN)
    return data[:last] + data[last:-2] * copies + data[-2:]


# A picture of one scan, told in a segment of notes, where a decoder does not look.
DISGUISE = bytes.fromhex("ffc0000b080030004003") + bytes(7) + bytes.fromhex("ffda000c03") + bytes(7)


@pytest.mark.parametrize("notes", [b"", b"\xff\xe1" + (2 + len(DISGUISE)).to_bytes(2) + DISGUISE])
def test_a_picture_of_endless_scans_is_refused(notes: bytes) -> None:
    start = b"\xff\xd8" + notes
    assert decode(start + progressive(copies=1)[2:]).shape == (48, 64, 3)
    with pytest.raises(BadImage, match="scans"):
        decode(start + progressive(copies=100)[2:])


def test_scans_behind_the_only_one_are_refused() -> None:
    stream = encode(picture(0))
    scan = stream.index(SCAN)
    with pytest.raises(BadImage, match="scan"):
        decode(stream[:-2] + stream[scan:-2] * 100 + stream[-2:])
