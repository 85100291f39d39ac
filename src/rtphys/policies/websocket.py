"""A websocket to a policy server: MessagePack with NumPy arrays, time limits, typed errors.

What a server sends is checked before it is used: nothing is unpickled, nothing grows without bound.
"""

import time
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field

import msgpack
import numpy as np
from websockets.exceptions import ConnectionClosed, InvalidHandshake, InvalidURI
from websockets.frames import CloseCode
from websockets.sync.client import ClientConnection, connect

from rtphys.core.bounds import LARGEST_MESSAGE, LONGEST_REPORT
from rtphys.core.errors import BadValue, RtphysError
from rtphys.policies.policy import PolicyGone, ServerFailed

FAREWELL = 1.0  # [s] that a server has to agree that the connection ends
RETRY = 1.0  # [s] between attempts to reach a server that is still loading its weights

# ---- messages ------------------------------------------------------------------------------------

# Kinds void, object, complex: openpi refuses all, XPolicyLab objects; no policy needs any.
REFUSED = "VOc"
LONGEST_TYPE = 32  # characters of an array's type; ours have 3
# What msgpack and numpy raise about bytes that are no message.
UNREADABLE = (
    *(TypeError, ValueError, OverflowError, SyntaxError, IndexError),
    *(MemoryError, RecursionError, msgpack.UnpackException),
)


class BadFrame(RtphysError):
    """Bytes are no message, or a message cannot hold a value."""


@dataclass(frozen=True)
class Encoding:
    """Encoding of arrays in a message. Decoded arrays own their memory and are writable."""

    name: str
    _encode: Callable[[np.ndarray | np.generic], dict[bytes, object]]
    _decode: Callable[[Mapping[object, object]], object]

    def pack(self, message: object) -> bytes:
        """Bytes of a message of mappings, sequences, numbers, text and arrays.

        Raises `BadFrame`: it holds another type, such as an array of objects.
        """

        def encoded(value: object) -> dict[bytes, object]:
            if not isinstance(value, np.ndarray | np.generic) or value.dtype.kind in REFUSED:
                raise TypeError(f"a {getattr(value, 'dtype', type(value).__name__)} is refused")
            return self._encode(value)

        try:
            return msgpack.packb(message, default=encoded)  # type: ignore[return-value]
        except (TypeError, ValueError, OverflowError) as error:
            raise BadFrame(f"{self.name}: cannot be packed: {error}") from error

    def unpack(self, data: bytes) -> object:
        """Inverse of `pack`; sequences become lists.

        Raises `BadFrame`: not MessagePack, or an array whose parts do not fit.
        """
        try:
            return msgpack.unpackb(data, object_hook=self._decode)
        except UNREADABLE as error:
            why = str(error)[:LONGEST_REPORT] or type(error).__name__
            raise BadFrame(f"{self.name}: cannot be unpacked: {why}") from error


def _type(name: object) -> np.dtype:
    if not isinstance(name, str | bytes) or len(name) > LONGEST_TYPE:
        raise ValueError("the type of an array is a short text")
    kind = np.dtype(name.decode() if isinstance(name, bytes) else name)
    if kind.kind in REFUSED:
        raise ValueError(f"arrays of {kind} are refused")
    return kind


def _array(data: object, dtype: object, shape: object) -> np.ndarray:
    kind = _type(dtype)
    if not isinstance(data, bytes) or not isinstance(shape, list | tuple):
        raise ValueError("an array needs bytes and a shape")
    return np.frombuffer(data, kind).reshape(shape).copy()


def _openpi_encode(value: np.ndarray | np.generic) -> dict[bytes, object]:
    kind = value.dtype.str
    if isinstance(value, np.generic):
        return {b"__npgeneric__": True, b"data": value.item(), b"dtype": kind}
    data, shape = value.tobytes(), value.shape
    return {b"__ndarray__": True, b"data": data, b"dtype": kind, b"shape": shape}


def _openpi_decode(mapping: Mapping[object, object]) -> object:
    if b"__ndarray__" in mapping:
        return _array(mapping.get(b"data"), mapping.get(b"dtype"), mapping.get(b"shape"))
    if b"__npgeneric__" in mapping:
        kind, data = _type(mapping.get(b"dtype")), mapping.get(b"data")
        # numpy makes an array of a list, and as many bytes as a number says.
        if not isinstance(data, str | bytes if kind.kind in "SU" else bool | int | float | str):
            raise ValueError(f"no scalar of {kind}")
        return kind.type(data)
    return mapping


def _plain_encode(value: np.ndarray | np.generic) -> dict[bytes, object]:
    kind, data = value.dtype.str, value.tobytes()
    if isinstance(value, np.generic):
        return {b"nd": False, b"type": kind, b"data": data}
    return {b"nd": True, b"type": kind, b"kind": b"", b"shape": value.shape, b"data": data}


def _plain_decode(mapping: Mapping[object, object]) -> object:
    if b"nd" not in mapping:
        return mapping
    if mapping.get(b"kind"):  # structured (V) or pickled (O); unpickling would run foreign code
        raise ValueError(f"arrays of kind {mapping.get(b'kind')!r} are refused")
    if mapping[b"nd"]:
        return _array(mapping.get(b"data"), mapping.get(b"type"), mapping.get(b"shape"))
    return _array(mapping.get(b"data"), mapping.get(b"type"), [1])[0]


OPENPI = Encoding("openpi", _openpi_encode, _openpi_decode)
MSGPACK_NUMPY = Encoding("msgpack-numpy", _plain_encode, _plain_decode)
"""Encoding of the package msgpack-numpy, used in XPolicyLab's frames."""


# ---- the connection ------------------------------------------------------------------------------


@dataclass(frozen=True)
class Endpoint:
    """Address of a server, its encoding and its time limits."""

    url: str  # HOST:PORT or ws://HOST:PORT
    encoding: Encoding
    reply_s: float = 600.0  # [s] limit for one answer
    connect_s: float = 30.0  # [s] during which to retry to connect
    headers: Mapping[str, str] = field(default_factory=dict)  # of the HTTP handshake

    def __post_init__(self) -> None:
        if not self.url:
            raise BadValue("policy", "", "name the server: HOST:PORT")
        if "://" not in self.url:
            object.__setattr__(self, "url", f"ws://{self.url}")


class Connection:
    """An open websocket; messages are packed with the endpoint's encoding.

    Raises `PolicyGone`: no server accepted the connection within `connect_s`.
    """

    def __init__(self, endpoint: Endpoint) -> None:
        self.endpoint = endpoint
        deadline = time.monotonic() + endpoint.connect_s
        while True:
            try:
                self._socket = self._connect()
                return
            except InvalidURI as error:
                raise PolicyGone(endpoint.url, f"not a websocket address: {error}") from error
            except (OSError, InvalidHandshake, TimeoutError, EOFError) as error:
                if time.monotonic() + RETRY > deadline:
                    problem = f"no server answered within {endpoint.connect_s:g} s"
                    if isinstance(error, InvalidHandshake):
                        problem = "what answers there opens no websocket"
                    raise PolicyGone(endpoint.url, f"{problem}: {error}") from error
                time.sleep(RETRY)

    def _connect(self) -> ClientConnection:
        # `__enter__`, because newer releases require it; `close` replaces `__exit__`.
        return connect(
            self.endpoint.url,
            additional_headers=dict(self.endpoint.headers),
            compression=None,
            max_size=LARGEST_MESSAGE,
            close_timeout=FAREWELL,
            # A model that computes for a minute answers no ping and would be disconnected.
            ping_interval=None,
            open_timeout=max(self.endpoint.connect_s, 1.0),
            proxy=None,
        ).__enter__()

    def send(self, message: object) -> None:
        """Send one message. Raises `PolicyGone`, `BadFrame`."""
        packed = self.endpoint.encoding.pack(message)
        try:
            self._socket.send(packed)
        except (ConnectionClosed, OSError) as error:
            raise self._gone(error) from error

    def receive(self) -> object:
        """Wait for the next message.

        Raises `PolicyGone`: the server closed the connection, sent nothing for `reply_s`, or more
        than `LARGEST_MESSAGE`; `ServerFailed`: the server sent text, which is its traceback;
        `BadFrame`: the server sent bytes that are no message.
        """
        try:
            raw = self._socket.recv(timeout=self.endpoint.reply_s)
        except TimeoutError as error:
            problem = f"no answer within {self.endpoint.reply_s:g} s"
            raise PolicyGone(self.endpoint.url, problem) from error
        except (ConnectionClosed, OSError) as error:
            raise self._gone(error) from error
        if isinstance(raw, str):
            raise ServerFailed(f"{self.endpoint.url} failed:\n{raw[-LONGEST_REPORT:]}")
        try:
            return self.endpoint.encoding.unpack(raw)
        except BadFrame as error:
            raise BadFrame(f"{self.endpoint.url}: {error}") from error

    def close(self) -> None:
        self._socket.close()

    def _gone(self, error: Exception) -> PolicyGone:
        problem = f"the server is gone: {error}"
        sent = getattr(error, "sent", None)  # why we closed the connection
        if sent is not None and sent.code == CloseCode.MESSAGE_TOO_BIG:
            problem = f"sent a message of more than {LARGEST_MESSAGE} bytes"
        return PolicyGone(self.endpoint.url, problem[:LONGEST_REPORT])
