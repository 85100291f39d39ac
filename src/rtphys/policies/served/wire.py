"""NumPy arrays inside MessagePack, in the two encodings that policy servers speak."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass

import msgpack
import numpy as np

from rtphys.core.errors import RtphysError

# void, object, complex: openpi refuses all three, XPolicyLab the second; no policy needs any.
REFUSED = "VOc"


class BadFrame(RtphysError):
    """Bytes that are no message, or a value that no message can hold."""


@dataclass(frozen=True)
class Encoding:
    """How an array looks on the wire. Decoded arrays own their memory and may be written to."""

    name: str
    _encode: Callable[[np.ndarray | np.generic], dict[bytes, object]]
    _decode: Callable[[Mapping[object, object]], object]

    def pack(self, message: object) -> bytes:
        """A message of mappings, sequences, numbers, text and arrays as bytes.

        Raises:
            BadFrame: it holds something else, such as an array of objects.
        """
        try:
            packed = msgpack.packb(message, default=self._default)
        except (TypeError, ValueError, OverflowError) as error:
            raise BadFrame(f"{self.name}: cannot be packed: {error}") from error
        assert packed is not None
        return packed

    def unpack(self, data: bytes) -> object:
        """Inverse of `pack`; sequences come back as lists.

        Raises:
            BadFrame: not MessagePack, or an array whose parts do not fit.
        """
        try:
            return msgpack.unpackb(data, object_hook=self._hook)
        except (TypeError, ValueError, msgpack.UnpackException) as error:
            why = str(error) or type(error).__name__
            raise BadFrame(f"{self.name}: cannot be unpacked: {why}") from error

    def _default(self, value: object) -> dict[bytes, object]:
        if not isinstance(value, np.ndarray | np.generic):
            raise TypeError(f"a {type(value).__name__} has no place in a message")
        if value.dtype.kind in REFUSED:
            raise TypeError(f"arrays of {value.dtype} are refused")
        return self._encode(value)

    def _hook(self, found: dict[object, object]) -> object:
        return self._decode(found)


def _array(data: object, dtype: object, shape: object) -> np.ndarray:
    kind = np.dtype(str(dtype))
    if kind.kind in REFUSED:
        raise ValueError(f"arrays of {kind} are refused")
    if not isinstance(data, bytes) or not isinstance(shape, list | tuple):
        raise ValueError("an array needs bytes and a shape")
    return np.frombuffer(data, kind).reshape(shape).copy()


def _openpi_encode(value: np.ndarray | np.generic) -> dict[bytes, object]:
    if isinstance(value, np.generic):
        return {b"__npgeneric__": True, b"data": value.item(), b"dtype": value.dtype.str}
    return {
        b"__ndarray__": True,
        b"data": value.tobytes(),
        b"dtype": value.dtype.str,
        b"shape": value.shape,
    }


def _openpi_decode(found: Mapping[object, object]) -> object:
    if b"__ndarray__" in found:
        return _array(found.get(b"data"), found.get(b"dtype"), found.get(b"shape"))
    if b"__npgeneric__" in found:
        kind = np.dtype(str(found.get(b"dtype")))
        if kind.kind in REFUSED:
            raise ValueError(f"scalars of {kind} are refused")
        return kind.type(found.get(b"data"))
    return found


def _plain_encode(value: np.ndarray | np.generic) -> dict[bytes, object]:
    if isinstance(value, np.generic):
        return {b"nd": False, b"type": value.dtype.str, b"data": value.tobytes()}
    return {
        b"nd": True,
        b"type": value.dtype.str,
        b"kind": b"",
        b"shape": value.shape,
        b"data": value.tobytes(),
    }


def _plain_decode(found: Mapping[object, object]) -> object:
    if b"nd" not in found:
        return found
    if found.get(b"kind"):  # structured (V) or pickled (O): the latter would run foreign code
        raise ValueError(f"arrays of kind {found.get(b'kind')!r} are refused")
    if found[b"nd"]:
        return _array(found.get(b"data"), found.get(b"type"), found.get(b"shape"))
    return _array(found.get(b"data"), found.get(b"type"), [1])[0]


OPENPI = Encoding("openpi", _openpi_encode, _openpi_decode)
MSGPACK_NUMPY = Encoding("msgpack-numpy", _plain_encode, _plain_decode)
"""The format of the package of that name, which XPolicyLab's frames use."""
