"""Arrays on the wire: what goes in comes out, and what could run code is refused."""

import msgpack
import numpy as np
import pytest
from hypothesis import given
from hypothesis.extra import numpy as hnp

from rtphys.policies.websocket import MSGPACK_NUMPY, OPENPI, BadFrame, Encoding

BOTH = pytest.mark.parametrize("encoding", [OPENPI, MSGPACK_NUMPY], ids=lambda e: e.name)
NUMBERS = hnp.integer_dtypes() | hnp.floating_dtypes(sizes=(32, 64)) | hnp.boolean_dtypes()


@BOTH
@given(array=hnp.arrays(NUMBERS, hnp.array_shapes(min_dims=0, min_side=0, max_dims=3)))
def test_an_array_survives(encoding: Encoding, array: np.ndarray) -> None:
    back = encoding.unpack(encoding.pack({"a": [array]}))
    assert isinstance(back, dict)
    got = np.asarray(back["a"][0])
    assert got.shape == array.shape
    assert got.dtype == array.dtype
    np.testing.assert_array_equal(got, array)


@BOTH
def test_a_scalar_survives_and_a_decoded_array_may_be_written_to(encoding: Encoding) -> None:
    assert encoding.unpack(encoding.pack(np.float32(0.1))) == np.float32(0.1)
    back = encoding.unpack(encoding.pack(np.zeros(3)))
    assert isinstance(back, np.ndarray)
    back += 1


OPENPIS = {b"__ndarray__": True, b"data": b"\1\2", b"dtype": "|u1", b"shape": [1, 2]}
PLAINS = {b"nd": True, b"type": "|u1", b"kind": b"", b"shape": [1, 2], b"data": b"\1\2"}


@pytest.mark.parametrize(("encoding", "keys"), [(OPENPI, OPENPIS), (MSGPACK_NUMPY, PLAINS)])
def test_each_writes_its_own_keys(encoding: Encoding, keys: dict[bytes, object]) -> None:
    assert msgpack.unpackb(encoding.pack(np.array([[1, 2]], np.uint8))) == keys


@BOTH
@pytest.mark.parametrize("value", [np.array([object()]), np.array([1j]), np.void(b"x"), object()])
def test_what_no_policy_needs_is_refused(encoding: Encoding, value: object) -> None:
    with pytest.raises(BadFrame, match=encoding.name):
        encoding.pack({"a": value})


@pytest.mark.parametrize(
    ("encoding", "found"),
    [
        (OPENPI, {b"__ndarray__": True, b"data": b"12345678", b"dtype": "|O", b"shape": [1]}),
        (OPENPI, {b"__npgeneric__": True, b"data": b"x", b"dtype": "|O"}),
        (MSGPACK_NUMPY, {b"nd": True, b"type": "|O", b"kind": b"O", b"shape": [1], b"data": b""}),
        (MSGPACK_NUMPY, {b"nd": True, b"type": "<f8", b"kind": b"", b"shape": [3], b"data": b""}),
    ],
)
def test_a_hostile_answer_is_an_error(encoding: Encoding, found: dict[bytes, object]) -> None:
    with pytest.raises(BadFrame):
        encoding.unpack(msgpack.packb(found) or b"")
