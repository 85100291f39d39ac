"""A policy server that means harm: one sentence, within seconds, in little memory."""

import resource
import time
from collections.abc import Callable
from contextlib import suppress

import msgpack
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from servers import serving
from websockets.sync.server import ServerConnection

from rtphys.core.bounds import LARGEST_MESSAGE, LONGEST_REPORT, MAX_STALE
from rtphys.core.errors import RtphysError
from rtphys.policies import PolicyGone, PolicySetup, open_policy
from rtphys.policies.openpi import OpenPi
from rtphys.policies.websocket import MSGPACK_NUMPY, OPENPI, BadFrame, Encoding

SECONDS = 10.0  # [s]
MEMORY = 2**28  # [bytes] more than before, of server and client
BOTH = pytest.mark.parametrize("encoding", [OPENPI, MSGPACK_NUMPY], ids=lambda e: e.name)
SIZES = (-1, 2**31, 2**62, 10**18)
TYPES = ("O", "V9", "f4,f4", "(1000000000,)f8", "S9999999999", "M8[ns]", "x" * 10**6, "", 3, None)
TYPES += ("<f8" * 9, "f8" + "," * 20, "(", "{}", "|S0", "object", "c16", [["a", "<f8"]], b"\xff")


def arrays() -> list[dict[bytes, object]]:
    """Arrays and scalars in both encodings whose parts do not fit."""
    made: list[dict[bytes, object]] = []
    for kind in TYPES:
        for data in (b"", b"x" * 8, 10**12, [1] * 9, None):
            shape = [1]
            made.append({b"__ndarray__": True, b"data": data, b"dtype": kind, b"shape": shape})
            made.append({b"nd": True, b"data": data, b"type": kind, b"kind": b"", b"shape": shape})
            made.append({b"__npgeneric__": True, b"data": data, b"dtype": kind})
            made.append({b"nd": False, b"data": data, b"type": kind})
    for kind in ("S1000000000", "U1000000000", "<f8"):
        for size in SIZES:
            made.append({b"__npgeneric__": True, b"data": size, b"dtype": kind})
            shape = [size, size]
            made.append({b"__ndarray__": True, b"data": b"x", b"dtype": kind, b"shape": shape})
            made.append({b"nd": True, b"data": b"x", b"type": kind, b"shape": [size] * 99})
    return made


RAW = (
    b"",
    b"\xc1",
    b"\x91" * 10**6,  # a list in a list in a list
    b"\x81\xa1a" * 10**5,
    b"\xdd\xff\xff\xff\xff",  # a list of four thousand million
    b"\xdf\xff\xff\xff\xff",
    b"\xc6\xff\xff\xff\xff",
    b"\xc9\xff\xff\xff\xff\x05",
    b"\x81\x90\x01",  # a list as a key
    b"\xd6\xff\x00\x00\x00\x00",  # a time
    b"\xa1\xff",  # text that is no UTF-8
)


@BOTH
def test_every_message_is_one_or_is_refused(encoding: Encoding) -> None:
    began, peak = time.monotonic(), resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    messages = [*RAW, *(msgpack.packb({"actions": array}) for array in arrays())]
    for message in messages:
        try:
            encoding.unpack(message)
        except BadFrame as error:
            assert len(str(error)) < LONGEST_REPORT + 100
    assert len(messages) > 400
    assert time.monotonic() - began < SECONDS
    assert (resource.getrusage(resource.RUSAGE_SELF).ru_maxrss - peak) * 1024 < MEMORY


@BOTH
@settings(max_examples=200)
@given(data=st.binary(max_size=80))
def test_any_bytes(encoding: Encoding, data: bytes) -> None:
    with suppress(BadFrame):
        encoding.unpack(data)


def said(handler: Callable[[ServerConnection], None], policy: str) -> str:
    """What becomes of a policy's first request. It must be an `RtphysError`."""
    began = time.monotonic()
    with serving(handler) as where, pytest.raises(RtphysError) as caught:
        opened = open_policy(f"{policy}:{where}?reply_s=5&connect_s=5", PolicySetup("click_bell"))
        assert isinstance(opened, OpenPi)
        try:
            opened.infer({"state": np.zeros(14)})
        finally:
            opened.close()
    assert time.monotonic() - began < SECONDS
    return str(caught.value)


def each(*messages: bytes | str, greeting: object = None) -> Callable[[ServerConnection], None]:
    """A server that says these things to the first request, and openpi's greeting before it."""

    def handle(socket: ServerConnection) -> None:
        if greeting is not None:
            socket.send(OPENPI.pack(greeting))
        socket.recv()
        for message in messages:
            socket.send(message)
        socket.recv()

    return handle


HUGE = b"\x90" + bytes(LARGEST_MESSAGE)


def test_a_message_of_any_size_ends_the_connection() -> None:
    peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    sentence = f"more than {LARGEST_MESSAGE} bytes"
    assert sentence in said(each(HUGE), "xpolicylab")
    assert sentence in said(each(HUGE, greeting={}), "openpi")
    assert (resource.getrusage(resource.RUSAGE_SELF).ru_maxrss - peak) * 1024 < MEMORY


def test_a_message_in_a_million_pieces() -> None:
    def handle(socket: ServerConnection) -> None:
        socket.recv()
        socket.send(bytes(2**16) for _ in range(10**5))

    assert f"more than {LARGEST_MESSAGE} bytes" in said(handle, "xpolicylab")


def test_a_long_traceback_is_cut() -> None:
    assert len(said(each("x" * 10**7, greeting={}), "openpi")) < LONGEST_REPORT + 200
    error = {"message_type": "error", "payload": {"message": "x" * 10**7}, "message_id": "rtphys-1"}
    assert len(said(each(MSGPACK_NUMPY.pack(error)), "xpolicylab")) < LONGEST_REPORT + 200


def test_answers_to_nobody_do_not_go_on_for_ever() -> None:
    stale = MSGPACK_NUMPY.pack({"message_id": "another"})
    assert f"{MAX_STALE} messages" in said(each(*[stale] * (MAX_STALE + 9)), "xpolicylab")


@pytest.mark.parametrize("payload", [3, "text", [1], True, b"x"])
def test_a_payload_of_another_kind(payload: object) -> None:
    frame = {"message_id": "rtphys-1", "message_type": "hello_ack", "payload": payload}
    assert "payload" in said(each(MSGPACK_NUMPY.pack(frame)), "xpolicylab")


def test_the_address_of_no_websocket() -> None:
    for where in ("ws://", "http://x", "file:///etc/hostname", "ws://[", "ws://h:99999", "\0:1"):
        with pytest.raises((PolicyGone, RtphysError)):
            open_policy(f"openpi:{where}?connect_s=0.1", PolicySetup())
